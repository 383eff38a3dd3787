/* What amalgamate.sh cannot know from text alone: `settings MODULE` prints the settings block
   and its accessors, `levels` the unrolled samples of the shipped count, from the same functions
   that the tests prove; `table` and `graph` print the settings for README.md and the frame graph
   for docs/algorithm.md. Developer's tool, not shipped. */
#define LINEAO_IMPLEMENTATION
#include "lineao.h"
#define SDFVESSEL_IMPLEMENTATION
#include "sdfvessel.h"
#define VESSELSURFACE_IMPLEMENTATION
#include "vesselsurface.h"

enum { SHIPPED_SAMPLES = 32, MOST_LEVELS = 8 };

static void print_settings(const lao_module *module) {
    uint32_t i;
    printf("LAO_SETTINGS_BLOCK(%u)\n", (module->setting_count + 3) / 4);
    for (i = 0; i < module->setting_count; i++) {
        printf("#define lao_setting_%s (lao_settings_rows[%u].%c)\n", module->settings[i].name,
               i / 4, "xyzw"[i % 4]);
    }
}

/* The settings as a Markdown table. */
static void print_table(void) {
    const lao_module *module = lao_lines_module();
    uint32_t i;
    printf("| setting | values | default | unit | meaning |\n|---|---|---|---|---|\n");
    for (i = 0; i < module->setting_count; i++) {
        const lao_setting_row *row = &module->settings[i];
        char standard[64];
        const char *c;
        snprintf(standard, sizeof standard, "%g", (double)row->standard);
        printf("| `%s` | ", row->name);
        if (row->type == LAO_SETTING_ENUM) {
            int index = 0;
            size_t n;
            for (c = row->choices; *c; c += n + (c[n] != 0), index++) {
                n = strcspn(c, "|");
                printf("%s`%.*s`", index ? ", " : "", (int)n, c);
                if (index == (int)row->standard) {
                    snprintf(standard, sizeof standard, "`%.*s`", (int)n, c);
                }
            }
        } else if (row->type == LAO_SETTING_BOOL) {
            printf("`off`, `on`");
            snprintf(standard, sizeof standard, "%s", row->standard > 0 ? "`on`" : "`off`");
        } else {
            printf("%g .. %g%s", (double)row->minimum, (double)row->maximum,
                   row->type == LAO_SETTING_INT ? ", whole" : "");
        }
        printf(" | %s | %s | ", standard, row->unit);
        for (c = row->help; *c; c++) {
            printf(*c == '|' ? "\\%c" : "%c", *c);
        }
        printf(" |\n");
    }
}

static void print_graph_text(void *user, const char *text) {
    (void)user;
    fputs(text, stdout);
}

/* The frame graph as Graphviz text. */
static void print_graph(void) {
    const lao_module *module = lao_lines_module();
    lao_graph_print(&module, 1, print_graph_text, NULL);
}

/* Of level 0 the G-buffer's own: a stage has 16 textures for sure. */
static void print_tangent(uint32_t level) {
    if (level)
        printf("tangent%u", level);
    else
        printf("tangent");
}

/* Four at a time, then the rest: three together or one by one. */
static void print_samples(uint32_t level, uint32_t count) {
    static const char *const words[] = {"", "one", "", "three", "four"};
    uint32_t i, k, n;
    for (i = 0; i < count; i += n) {
        n = count - i >= 4 ? 4 : count - i == 3 ? 3 : 1;
        printf("            sum = lao_sample_%s(sum, level%u, ", words[n], level);
        print_tangent(level);
        printf(", c, g");
        for (k = 0; k < n; k++) {
            lao_v3 d = lao_sample_direction(level, i + k, count);
            printf(", lao_v3_make(%.9g, %.9g, %.9g)", (double)d.x, (double)d.y, (double)d.z);
        }
        printf(");\n");
    }
}

static void print_levels(void) {
    uint32_t level;
    for (level = 0; level < MOST_LEVELS; level++) {
        printf("    if (lao_constant_levels > %u) {\n", level);
        printf("        lao_gather g = lao_gather_make(level%u, c, %uu);\n", level, level);
        printf("        LAO_EXACT vec2 sum = vec2(0.0);\n");
        printf("        if (lao_constant_samples == %d) {\n", SHIPPED_SAMPLES);
        print_samples(level, lao_sample_count(SHIPPED_SAMPLES, level));
        printf("        } else {\n");
        printf("            sum = lao_sample_loop(level%u, ", level);
        print_tangent(level);
        printf(", c, g, %uu);\n        }\n", level);
        printf("        LAO_EXACT float mean = sum.x / lao_max(sum.y, 1.0);\n        total = total "
               "+ mean;\n    }\n");
    }
}

int main(int argc, char **argv) {
    const lao_module *modules[3];
    size_t i;
    modules[0] = lao_lines_module();
    modules[1] = sdv_module();
    modules[2] = vsf_module();
    for (i = 0; argc == 3 && i < sizeof modules / sizeof modules[0]; i++) {
        if (strcmp(argv[1], "settings") == 0 && strcmp(argv[2], modules[i]->name) == 0) {
            print_settings(modules[i]);
            return 0;
        }
    }
    if (argc == 2 && strcmp(argv[1], "levels") == 0) {
        print_levels();
        return 0;
    }
    if (argc == 2 && strcmp(argv[1], "table") == 0) {
        print_table();
        return 0;
    }
    if (argc == 2 && strcmp(argv[1], "graph") == 0) {
        print_graph();
        return 0;
    }
    fprintf(stderr, "usage: shader_text settings MODULE|levels|table|graph\n");
    return 2;
}
