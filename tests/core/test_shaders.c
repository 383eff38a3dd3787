/* No pass of the shipped modules reads more textures than a stage has on every device of OpenGL 3.3
   or Vulkan, whatever the settings: rows, shaders and limits fit together. */
#include "lineao.h"
#include "sdfvessel.h"
#include "vesselsurface.h"

#define LINEAO_SHADERS_GLSL
#include "lineao_shaders.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

enum { LEAST_UNITS = 16 }; /* GL_MAX_TEXTURE_IMAGE_UNITS, maxPerStageDescriptorSampledImages */

static const lao_shader *shader_of(const char *name) {
    for (uint32_t i = 0; i < lao_shader_count; i++)
        if (strcmp(lao_shaders[i].name, name) == 0)
            return &lao_shaders[i];
    return NULL;
}

static void rows_fit_every_device(void **state) {
    const lao_module *modules[] = {lao_lines_module(), sdv_module(), vsf_module(),
                                   sdv_pull_push_module()};
    lao_graph graph;
    char text[256] = "";
    (void)state;
    assert_true(LAO_MAX_READS <= LEAST_UNITS);
    assert_int_equal(lao_graph_make(modules, 4, NULL, &graph), LAO_OK);
    if (lao_graph_check(&graph, lao_shaders, lao_shader_count, text, sizeof text) != 0)
        fail_msg("%s", text);
    for (uint32_t i = 0; i < graph.pass_count; i++) {
        const lao_pass_row *row = graph.passes[i];
        const lao_shader *shader = shader_of(row->shader);
        uint32_t reads = 0;
        assert_non_null(shader);
        while (reads < LAO_MAX_READS && row->reads[reads].image)
            reads++;
        assert_true(shader->texture_count <= LEAST_UNITS && reads <= shader->texture_count);
    }
    lao_graph_free(NULL, &graph);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(rows_fit_every_device)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
