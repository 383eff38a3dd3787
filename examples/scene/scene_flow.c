/* Pathlines of flow_phantom.h and flow_aneurysm.h, integrated by flow4d.h: the whole way from a
 * velocity field to a picture. */
#include "flow_aneurysm.h"
#include "flow_phantom.h"
#include "scene_build.h"

#include <string.h>

static void trace(scene_builder *builder, uint32_t count, const flow4d_field *field, uint32_t steps,
                  double duration) {
    flow4d_trace_settings settings;
    flow4d_lines lines;
    memset(&settings, 0, sizeof settings);
    settings.line_count = count;
    settings.seed = builder->seed;
    settings.step = field->period / steps;
    settings.max_points = steps;
    settings.duration = duration;
    if (flow4d_trace(NULL, field, &settings, &lines) != LAO_OK) {
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

void scene_build_flow(scene_builder *builder, uint32_t count) {
    flow4d_field field;
    flow_phantom_field(&field);
    trace(builder, count, &field, 200, 0);
}

/* Shorter steps: a way through the sac bends within a few millimetres. What turns there does so for
 * at most 400 ms. */
void scene_build_aneurysm(scene_builder *builder, uint32_t count) {
    flow4d_field field;
    if (!flow_aneurysm_field(&field)) {
        builder->failed = true;
        return;
    }
    trace(builder, count, &field, 250, 200);
    flow_aneurysm_free(&field);
}
