/* What amalgamate.sh cannot know from text alone: `settings` prints the accessors of the settings block, `levels` the
   unrolled samples of the shipped count, from the same functions that the tests prove. Developer's tool, not shipped. */
#define LINEAO_IMPLEMENTATION
#include "lineao.h"

enum { SHIPPED_SAMPLES = 32, MOST_LEVELS = 8 };

static void print_settings(void) {
    const lao_module *module = lao_lines_module();
    uint32_t i;
    printf("#define LAO_SETTINGS_ROWS %u\n", (module->setting_count + 3) / 4);
    for (i = 0; i < module->setting_count; i++) {
        printf("#define lao_setting_%s (lao_settings_rows[%u].%c)\n", module->settings[i].name, i / 4, "xyzw"[i % 4]);
    }
}

static void print_levels(void) {
    uint32_t level, i;
    for (level = 0; level < MOST_LEVELS; level++) {
        uint32_t count = lao_sample_count(SHIPPED_SAMPLES, level);
        printf("    if (lao_constant_levels > %u) {\n", level);
        printf("        lao_gather g = lao_gather_make(depth%u, axial%u, c, %uu);\n", level, level, level);
        printf("        LAO_EXACT vec2 sum = vec2(0.0);\n");
        printf("        if (lao_constant_samples == %d) {\n", SHIPPED_SAMPLES);
        for (i = 0; i < count; i++) {
            lao_v3 d = lao_sample_direction(level, i, count);
            printf("            sum = sum + lao_sample_weight(depth%u, axial%u, tangent%u, c, g, lao_v3_make(%.9g, %.9g, %.9g));\n",
                   level, level, level, (double)d.x, (double)d.y, (double)d.z);
        }
        printf("        } else {\n");
        printf("            sum = lao_sample_loop(depth%u, axial%u, tangent%u, c, g, %uu);\n        }\n", level, level, level, level);
        printf("        LAO_EXACT float mean = sum.x / lao_max(sum.y, 1.0);\n        total = total + mean;\n    }\n");
    }
}

int main(int argc, char **argv) {
    if (argc == 2 && strcmp(argv[1], "settings") == 0) {
        print_settings();
        return 0;
    }
    if (argc == 2 && strcmp(argv[1], "levels") == 0) {
        print_levels();
        return 0;
    }
    fprintf(stderr, "usage: shader_text settings|levels\n");
    return 2;
}
