/* Pathlines of the phantom of flow_phantom.h, integrated by flow4d.h: the whole way from a velocity
 * field to a picture. */
#include "flow_phantom.h"
#include "scene_build.h"

#include <string.h>

void scene_build_flow(scene_builder *builder, uint32_t count) {
    flow4d_field field;
    flow4d_trace_settings settings;
    flow4d_lines lines;
    flow_phantom_field(&field);
    memset(&settings, 0, sizeof settings);
    settings.line_count = count;
    settings.seed = builder->seed;
    if (flow4d_trace(NULL, &field, &settings, &lines) != LAO_OK) {
        builder->failed = true;
        return;
    }
    for (uint32_t i = 0; i < lines.line_count; i++) {
        for (uint32_t k = lines.offsets[i]; k < lines.offsets[i + 1]; k++) {
            const float *p = lines.points + 3 * (size_t)k;
            scene_point(builder, vec3_make((double)p[0], (double)p[1], (double)p[2]),
                        (double)lines.times[k], (double)lines.speeds[k]);
        }
        scene_end_line(builder);
    }
    flow4d_lines_free(&lines);
}
