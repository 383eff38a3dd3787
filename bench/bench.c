/* lineao_bench: how long frames and passes take, beside floors measured in the same frames. */
#include "bench.h"

#include "bench_case.h"
#include "bench_flow.h"
#include "bench_screen.h"
#include "bench_surface.h"
#include "bench_vessel.h"
#include "bench_modules.h"
#include "bench_report.h"
#include "bench_scene.h"
#include "bench_table1.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- options ------------------------------------------------------------------------------ */

enum { MOST = 8 };

typedef struct bench_size {
    uint32_t width, height, supersampling;
} bench_size;

typedef struct bench_options {
    bench_case common; /* backends, presets, frames */
    uint32_t lines[MOST], line_count;
    bench_size sizes[MOST];
    uint32_t size_count;
    bool json, data, quick, flow, vessel, screen, surface, help, table1;
    const char *export_lines, *export_fills;
} bench_options;

static const char usage[] =
    "usage: lineao bench [FLAGS]\n"
    "  --json                  one JSON object instead of a table\n"
    "  --backend gl|vk|both    (both)\n"
    "  --presets NAME,...      (default,classic); memory: of the first\n"
    "  --halo NAME             of all presets: none, uniform, depth (depth)\n"
    "  --lines N,...           lines of 100 points of the scene `bundle` (1000,5000,30000)\n"
    "  --size WxH[@S],...      view size and supersampling (853x917,853x917@2: 853x917 and\n"
    "                          1706x1834 pixels)\n"
    "  --frames N              measured frames, after 2 to warm up (7)\n"
    "  --data                  also the real line sets in $LINEAO_DATA\n"
    "  --table1                instead: Table 1 of Koehler 2017, static and animated frames of "
    "the\n"
    "                          scene `aorta` (30000 lines, 853x917@2, 3 frames), each "
    "configuration\n"
    "                          over the first, beside the paper's quotient\n"
    "  --quick                 1000 lines at 214x230, 3 frames, unless told otherwise\n"
    "  --flow                  instead: pathlines of flow4d.h, 30000 (--quick: 1000; --lines N)\n"
    "  --vessel                instead: fields of embedded vessel trees and rays through them\n"
    "  --screen                instead: the void, the guiding field, the parameterization and the "
    "ink\n"
    "                          of vessels at 512, 1024 and 2048 pixels squared, beside their "
    "floors\n"
    "  --surface               instead: frames of meshes of 10,000 to 1,000,000 triangles, per "
    "pass\n"
    "  --export-lines FILE     only write lines and camera for bench/vtk_peer.py\n"
    "  --export-fills FOLDER   with --screen: only pull-push beside inverse distances, and their\n"
    "                          pictures for bench/fill_peer.py\n"
    "\n"
    "Passes are timed with a finish (OpenGL) or timestamps (Vulkan), in the same frames as their\n"
    "floors: floor_lines, the same quads with one flat colour and one target; floor_taps, as many\n"
    "reads as the occlusion (59), of the same images, on every pixel, and nothing else.\n"
    "X_over_Y: median of the quotients of each frame. occlusion_over_floor: by covered pixel,\n"
    "from least times, less what the background costs, which a frame without lines tells.\n"
    "occlusion_over_covered: a background pixel's cost over a covered one's. peak_mb: the most\n"
    "memory of a process that only draws the first preset.\n";

static bool parse_number(const char *word, uint32_t most, char stop, uint32_t *out,
                         const char **end) {
    char *rest;
    if (*word < '0' || *word > '9')
        return false;
    errno = 0;
    unsigned long value = strtoul(word, &rest, 10);
    if (errno || value < 1 || value > most || (*rest && *rest != stop && !end))
        return false;
    *out = (uint32_t)value;
    if (end)
        *end = rest;
    return true;
}

static bool parse_lines(char *word, bench_options *options) {
    if (options->line_count == MOST)
        return bench_fail("--lines: more than %d counts", (int)MOST);
    return parse_number(word, 10000000, 0, &options->lines[options->line_count++], NULL) ||
           bench_fail("--lines: '%s' is not a count of 1 to 10000000", word);
}

static bool parse_size(char *word, bench_options *options) {
    if (options->size_count == MOST)
        return bench_fail("--size: more than %d sizes", (int)MOST);
    bench_size *size = &options->sizes[options->size_count++];
    const char *rest = word;
    size->supersampling = 1;
    bool ok = parse_number(rest, 16384, 'x', &size->width, &rest) && *rest++ == 'x' &&
              parse_number(rest, 16384, '@', &size->height, &rest);
    if (ok && *rest == '@')
        ok = parse_number(rest + 1, 4, 0, &size->supersampling, &rest);
    return (ok && !*rest) || bench_fail("--size: '%s' is not WxH or WxH@S, S of 1 to 4", word);
}

static bool parse_preset(char *word, bench_options *options) {
    lao_settings settings;
    const lao_module *module = lao_lines_module();
    memset(&settings, 0, sizeof settings);
    if (lao_setting_parse(module, lao_setting_find(module, "preset"), word, &settings) != 0)
        return bench_fail("--presets: there is no preset '%s'", word);
    if (options->common.preset_count == BENCH_PRESETS)
        return bench_fail("--presets: more than %d presets", (int)BENCH_PRESETS);
    options->common.presets[options->common.preset_count++] = word;
    return true;
}

static bool parse_backend(char *word, bench_options *options) {
    static const char *const names[] = {"gl", "vk"};
    options->common.backend_count = 0;
    for (int i = 0; i < 2; i++) {
        if (strcmp(word, names[i]) == 0 || strcmp(word, "both") == 0)
            options->common.backends[options->common.backend_count++] = names[i];
    }
    return options->common.backend_count ||
           bench_fail("--backend: '%s' is none of gl, vk, both", word);
}

static bool parse_frames(char *word, bench_options *options) {
    return parse_number(word, BENCH_FRAMES, 0, &options->common.frames, NULL) ||
           bench_fail("--frames: '%s' is not a count of 1 to %d", word, (int)BENCH_FRAMES);
}

static bool parse_halo(char *word, bench_options *options) {
    lao_settings settings;
    const lao_module *module = lao_lines_module();
    memset(&settings, 0, sizeof settings);
    options->common.halo = word;
    return lao_setting_parse(module, lao_setting_find(module, "halo"), word, &settings) == 0 ||
           bench_fail("--halo: '%s' is none of none, uniform, depth", word);
}

static bool parse_fills(char *word, bench_options *options) {
    options->export_fills = word;
    return true;
}
static bool parse_export(char *word, bench_options *options) {
    options->export_lines = word;
    return true;
}

typedef struct flag_row {
    const char *name;
    bool list; /* the value is cut at commas */
    bool (*parse)(char *word, bench_options *options);
} flag_row;

static const flag_row flags[] = {
    {"--backend", false, parse_backend},    {"--presets", true, parse_preset},
    {"--lines", true, parse_lines},         {"--size", true, parse_size},
    {"--frames", false, parse_frames},      {"--export-lines", false, parse_export},
    {"--export-fills", false, parse_fills}, {"--halo", false, parse_halo},
};

static bool parse_value(const flag_row *flag, char *value, bench_options *options) {
    while (flag->list && value) {
        char *comma = strchr(value, ',');
        if (comma)
            *comma++ = 0;
        if (!flag->parse(value, options))
            return false;
        value = comma;
    }
    return flag->list || flag->parse(value, options);
}

static bool parse_flag(int argc, char **argv, int *i, bench_options *options) {
    struct {
        const char *name;
        bool *value;
    } switches[] = {{"--json", &options->json},     {"--data", &options->data},
                    {"--quick", &options->quick},   {"--table1", &options->table1},
                    {"--flow", &options->flow},     {"--vessel", &options->vessel},
                    {"--screen", &options->screen}, {"--surface", &options->surface},
                    {"--help", &options->help}};
    for (size_t k = 0; k < sizeof switches / sizeof *switches; k++) {
        if (strcmp(argv[*i], switches[k].name) == 0)
            return *switches[k].value = true;
    }
    for (size_t k = 0; k < sizeof flags / sizeof *flags; k++) {
        if (strcmp(argv[*i], flags[k].name) != 0)
            continue;
        if (*i + 1 >= argc)
            return bench_fail("%s needs a value; see lineao bench --help", argv[*i]);
        return parse_value(&flags[k], argv[++*i], options);
    }
    return bench_fail("%s is not known; see lineao bench --help", argv[*i]);
}

/* The measures of the paper's Table 1. */
static void fill_in_table1(bench_options *options) {
    static const bench_size paper = {853, 917, 2};
    if (!options->line_count && !options->quick)
        options->lines[options->line_count++] = 30000;
    if (!options->size_count && !options->quick)
        options->sizes[options->size_count++] = paper;
    if (!options->common.frames)
        options->common.frames = 3;
}

static void fill_in(bench_options *options) {
    static const uint32_t lines[] = {1000, 5000, 30000};
    static const bench_size sizes[] = {{853, 917, 1}, {853, 917, 2}}, small = {214, 230, 1};
    if (options->table1)
        fill_in_table1(options);
    if (!options->common.halo)
        options->common.halo = "depth";
    if (!options->line_count) {
        options->line_count = options->quick ? 1 : 3;
        memcpy(options->lines, lines, sizeof lines);
    }
    if (!options->size_count) {
        options->size_count = options->quick ? 1 : 2;
        memcpy(options->sizes, options->quick ? &small : sizes,
               options->size_count * sizeof *sizes);
    }
    if (!options->common.preset_count) {
        options->common.preset_count = 2;
        options->common.presets[0] = "default";
        options->common.presets[1] = "classic";
    }
    if (!options->common.backend_count) {
        options->common.backend_count = 2;
        options->common.backends[0] = "gl";
        options->common.backends[1] = "vk";
    }
    if (!options->common.frames)
        options->common.frames = options->quick ? 3 : 7;
}

/* ---- a process for each measurement -------------------------------------------------------- */

/* Each case runs in a process of its own: the peak of memory is its own, nothing is left over from
 * the one before, and a driver's crash ends one case only. Its result comes through a pipe. */
typedef cJSON *(*work_fn)(const bench_case *it);

static void child_run(work_fn run, const bench_case *it, int out) {
    cJSON *result = run(it);
    char *words = result ? cJSON_PrintUnformatted(result) : NULL;
    size_t size = words ? strlen(words) : 0, done = 0;
    while (done < size) {
        ssize_t n = write(out, words + done, size - done);
        if (n < 0 && errno != EINTR)
            break;
        done += n > 0 ? (size_t)n : 0;
    }
    bool ok = words && done == size;
    cJSON_free(words);
    cJSON_Delete(result);
    close(out);
    exit(ok ? 0 : 1);
}

static char *read_all(int in) {
    size_t size = 0, capacity = 1 << 16;
    char *words = malloc(capacity);
    while (words) {
        ssize_t n = read(in, words + size, capacity - size - 1);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            break;
        size += (size_t)n;
        if (capacity - size < 2) {
            char *more = realloc(words, capacity *= 2);
            if (!more)
                free(words);
            words = more;
        }
    }
    if (words)
        words[size] = 0;
    return words;
}

static cJSON *in_child(work_fn run, const bench_case *it) {
    int ends[2], status = 0;
    fflush(NULL);
    if (pipe(ends) != 0) {
        bench_fail("no pipe: %s", strerror(errno));
        return NULL;
    }
    pid_t child = fork();
    if (child == 0) {
        close(ends[0]);
        child_run(run, it, ends[1]);
    }
    close(ends[1]);
    char *words = child > 0 ? read_all(ends[0]) : NULL;
    close(ends[0]);
    while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    cJSON *result = words && status == 0 ? cJSON_Parse(words) : NULL;
    free(words);
    if (child < 0)
        bench_fail("no process: %s", strerror(errno));
    else if (WIFSIGNALED(status))
        bench_fail("a measurement was ended by signal %d", WTERMSIG(status));
    else if (!result && status == 0)
        bench_fail("a measurement told nothing");
    return result; /* status of its own: it has reported */
}

/* ---- cases -------------------------------------------------------------------------------- */

static bool case_run(const bench_case *it, cJSON *scenes) {
    cJSON *scene = in_child(bench_case_run, it);
    if (!scene)
        return false;
    cJSON_AddItemToArray(scenes, scene);
    for (uint32_t b = 0; b < it->backend_count; b++) {
        bench_case one = *it;
        one.backends[0] = it->backends[b];
        one.backend_count = 1;
        cJSON *peak = in_child(bench_case_memory, &one);
        if (!peak)
            return false;
        cJSON *backends = cJSON_GetObjectItemCaseSensitive(scene, "backends");
        cJSON_AddItemToObject(cJSON_GetObjectItemCaseSensitive(backends, one.backends[0]),
                              "peak_mb", peak);
    }
    return true;
}

/* A scene in all sizes. */
static bool scene_run(const bench_options *options, const char *path, uint32_t lines,
                      cJSON *scenes) {
    for (uint32_t s = 0; s < options->size_count; s++) {
        bench_case it = options->common;
        it.path = path;
        it.line_count = lines;
        it.width = options->sizes[s].width;
        it.height = options->sizes[s].height;
        it.supersampling = options->sizes[s].supersampling;
        if (!options->json && isatty(STDERR_FILENO))
            fprintf(stderr, "measuring %s, %ux%u@%u\n", path ? path : "bundle", (unsigned)it.width,
                    (unsigned)it.height, (unsigned)it.supersampling);
        if (!case_run(&it, scenes))
            return false;
    }
    return true;
}

static void note(cJSON *notes, const char *before, const char *after) {
    char line[1200];
    snprintf(line, sizeof line, "%s%s", before, after);
    cJSON_AddItemToArray(notes, cJSON_CreateString(line));
}

static bool data_run(const bench_options *options, cJSON *scenes, cJSON *notes) {
    static const char *const names[] = {"example.trk", "TR_S_R.tt.gz", "INDI_rhesus.tt.gz"};
    const char *folder = getenv("LINEAO_DATA");
    if (!folder) {
        note(notes, "LINEAO_DATA is not set: no real line sets", "");
        return true;
    }
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char path[1024];
        if (snprintf(path, sizeof path, "%s/lines/%s", folder, names[i]) >= (int)sizeof path)
            return bench_fail("LINEAO_DATA is too long");
        if (access(path, R_OK) != 0)
            note(notes, "absent: ", path);
        else if (!scene_run(options, path, 0, scenes))
            return false;
    }
    return true;
}

static bool table1_run(const bench_options *options, cJSON *document) {
    bench_case it = options->common;
    it.line_count = options->lines[0];
    it.width = options->sizes[0].width;
    it.height = options->sizes[0].height;
    it.supersampling = options->sizes[0].supersampling;
    cJSON *backends = cJSON_AddObjectToObject(document, "table1");
    for (uint32_t b = 0; b < it.backend_count; b++) {
        bench_case one = it;
        one.backends[0] = it.backends[b];
        one.backend_count = 1;
        cJSON *rows = in_child(bench_table1_run, &one);
        if (!rows)
            return false;
        cJSON_AddItemToObject(backends, one.backends[0], rows);
    }
    return true;
}

static bool run(const bench_options *options, cJSON *document) {
    cJSON_AddStringToObject(document, "program", "lineao bench");
    cJSON_AddNumberToObject(document, "version", LAO_VERSION);
    cJSON_AddNumberToObject(document, "frames", options->common.frames);
    cJSON_AddNumberToObject(document, "warm_up", BENCH_WARM_UP);
    cJSON_AddNumberToObject(document, "processors", (double)sysconf(_SC_NPROCESSORS_ONLN));
    cJSON *notes = cJSON_AddArrayToObject(document, "notes");
    if (!bench_floors_have_words())
        note(notes, "built without glslangValidator: no floors on Vulkan", "");
    cJSON *scenes = cJSON_AddArrayToObject(document, "scenes");
    if (options->table1)
        return table1_run(options, document);
    for (uint32_t i = 0; i < options->line_count; i++) {
        if (!scene_run(options, NULL, options->lines[i], scenes))
            return false;
    }
    return !options->data || data_run(options, scenes, notes);
}

static bool export_run(const bench_options *options) {
    bench_scene scene;
    const bench_size *size = &options->sizes[0];
    bool ok = bench_scene_open(&scene, NULL, options->lines[0],
                               (double)size->width / (double)size->height) &&
              bench_scene_export(&scene, options->export_lines);
    bench_scene_release(&scene);
    return ok;
}

/* The JSON or the table of `--flow`, which needs no backend. */
static bool flow_run(const bench_options *options, cJSON *document) {
    uint32_t lines = options->quick ? 1000 : 30000;
    cJSON_AddStringToObject(document, "program", "lineao bench --flow");
    cJSON_AddNumberToObject(document, "version", LAO_VERSION);
    cJSON_AddNumberToObject(document, "processors", (double)sysconf(_SC_NPROCESSORS_ONLN));
    return bench_flow_run(document, options->line_count ? options->lines[0] : lines);
}

/* The same of `--vessel`. */
static bool vessel_run(const bench_options *options, cJSON *document) {
    cJSON_AddStringToObject(document, "program", "lineao bench --vessel");
    cJSON_AddNumberToObject(document, "version", LAO_VERSION);
    cJSON_AddNumberToObject(document, "processors", (double)sysconf(_SC_NPROCESSORS_ONLN));
    return bench_vessel_run(document, options->quick);
}

/* The same of `--screen`. */
static bool screen_run(const bench_options *options, cJSON *document) {
    cJSON_AddStringToObject(document, "program", "lineao bench --screen");
    cJSON_AddNumberToObject(document, "version", LAO_VERSION);
    cJSON_AddNumberToObject(document, "processors", (double)sysconf(_SC_NPROCESSORS_ONLN));
    return bench_screen_run(document, options->quick, options->export_fills);
}

/* The same of `--surface`. */
static bool surface_run(const bench_options *options, cJSON *document) {
    cJSON_AddStringToObject(document, "program", "lineao bench --surface");
    cJSON_AddNumberToObject(document, "version", LAO_VERSION);
    cJSON_AddNumberToObject(document, "processors", (double)sysconf(_SC_NPROCESSORS_ONLN));
    return bench_surface_run(document, options->quick);
}

static bool print_json(const cJSON *document) {
    char *words = cJSON_Print(document);
    if (words)
        puts(words);
    cJSON_free(words);
    return words || bench_fail("no memory");
}

int bench_command(int argc, char **argv) {
    bench_options options;
    memset(&options, 0, sizeof options);
    for (int i = 1; i < argc; i++) {
        if (!parse_flag(argc, argv, &i, &options))
            return 2;
    }
    if (options.help)
        return fputs(usage, stdout) < 0;
    bool lines = !options.flow && !options.vessel && !options.surface && !options.screen;
    if (lines)
        fill_in(&options);
    if (lines && options.export_lines)
        return export_run(&options) ? 0 : 1;
    cJSON *document = cJSON_CreateObject();
    bool ok = options.flow      ? flow_run(&options, document)
              : options.vessel  ? vessel_run(&options, document)
              : options.screen  ? screen_run(&options, document)
              : options.surface ? surface_run(&options, document)
                                : run(&options, document);
    if (ok && lines)
        bench_report_judge(document);
    if (ok && options.json)
        ok = print_json(document);
    else if (ok && options.flow)
        bench_flow_print(document);
    else if (ok && options.vessel)
        bench_vessel_print(document);
    else if (ok && options.screen)
        bench_screen_print(document);
    else if (ok && options.surface)
        bench_surface_print(document);
    else if (ok)
        bench_report_print(document);
    cJSON_Delete(document);
    return ok && fflush(stdout) == 0 ? 0 : 1;
}
