/* ================================================================================================
 * tables: the module of line sets: its images, passes, buffers, settings and presets. The
   implementation begins here and ends with the last section; all of it uses the interface and the
   shared text. */
#ifdef LINEAO_IMPLEMENTATION
#ifndef LINEAO_IMPLEMENTATION_DONE
#define LINEAO_IMPLEMENTATION_DONE

#ifndef LAO_ASSERT
#define LAO_ASSERT(condition) ((void)0)
#endif

#ifdef __cplusplus
extern "C" {
#endif

// clang-format off
#define LAO__NOTHING {NULL, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define LAO__READ(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define LAO__READ_FINER(image) {image, LAO_LEVEL_FINER, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define LAO__READ_LEVEL(image, level) {image, LAO_LEVEL_INDEX, level, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define LAO__READ_COARSE(image) LAO__READ_LEVEL(image, 1), LAO__READ_LEVEL(image, 2), LAO__READ_LEVEL(image, 3), LAO__READ_LEVEL(image, 4), \
                                LAO__READ_LEVEL(image, 5), LAO__READ_LEVEL(image, 6), LAO__READ_LEVEL(image, 7)
#define LAO__READ_ALL(image) LAO__READ_LEVEL(image, 0), LAO__READ_COARSE(image)
#define LAO__CLEAR(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_CLEAR}
#define LAO__KEEP(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_KEEP}
#define LAO__WRITE(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define LAO__OTHER(image) {image, LAO_LEVEL_SAME, 0, LAO_PHASE_OTHER, LAO_LOAD_DISCARD}
#define LAO__WRITE_LEVEL(image, level) {image, LAO_LEVEL_INDEX, level, LAO_PHASE_THIS, LAO_LOAD_DISCARD}
#define LAO__WRITE_ABOVE(image, level) {image, LAO_LEVEL_SAME, level, LAO_PHASE_THIS, LAO_LOAD_DISCARD} /* LAO_REPEAT_LEVELS_UP */
#define LAO__UNKNOWN 0.501960784f /* no tangent: 128 of 255, about 0 */
#define LAO__ALWAYS {{NULL, 0, 0}}
#define LAO__ANY {NULL, 0, 0}
#define LAO__LINES {"#points", '>', 0} /* sets of objects alone have nothing to draw or to shade here */

static const lao_image_row lao__images[] = {
    /* name          format              size           w  h  levels    flags             encoding               clear         when                                    channels */
    {"host_depth",    LAO_FORMAT_HOST,    LAO_SIZE_VIEW, 0, 0, NULL,     LAO_IMAGE_IMPORT, LAO_ENCODING_PLAIN,   {0, 0, 0, 0}, LAO__ANY,                               {NULL, NULL, NULL, NULL}},
    {"target",        LAO_FORMAT_HOST,    LAO_SIZE_VIEW, 0, 0, NULL,     LAO_IMAGE_IMPORT, LAO_ENCODING_PLAIN,   {0, 0, 0, 0}, LAO__ANY,                               {NULL, NULL, NULL, NULL}},
    {"color",         LAO_FORMAT_RGBA8,   LAO_SIZE_FULL, 0, 0, NULL,     0,                LAO_ENCODING_PLAIN,   {0, 0, 0, 0}, LAO__ANY,                               {"color.R", "color.G", "color.B", "mask.V"}},
    {"tangent",       LAO_FORMAT_RGBA16F, LAO_SIZE_FULL, 0, 0, NULL,     0,                LAO_ENCODING_PLAIN,   {0, 0, 0, 0}, LAO__ANY,                               {"tangent.X", "tangent.Y", "tangent.Z", "zoom.V"}},
    {"depth",         LAO_FORMAT_R32F,    LAO_SIZE_FULL, 0, 0, NULL,     0,                LAO_ENCODING_PLAIN,   {1, 1, 1, 1}, LAO__ANY,                               {"depth.Z", NULL, NULL, NULL}},
    {"zbuffer",       LAO_FORMAT_D32F,    LAO_SIZE_FULL, 0, 0, NULL,     0,                LAO_ENCODING_PLAIN,   {1, 0, 0, 0}, LAO__ANY,                               {NULL, NULL, NULL, NULL}},
    {"far_tiles",     LAO_FORMAT_R32F,    LAO_SIZE_FULL, 0, 0, "*",      0,                LAO_ENCODING_PLAIN,   {0, 0, 0, 0}, {"cull_hidden", '>', 0},                {NULL, NULL, NULL, NULL}},
    {"far",           LAO_FORMAT_R32F,    LAO_SIZE_FULL, 0, 0, "*",      0,                LAO_ENCODING_PLAIN,   {0, 0, 0, 0}, {"cull_hidden", '>', 0},                {NULL, NULL, NULL, NULL}},
    {"tensor",        LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, "levels", 0,                LAO_ENCODING_PLAIN,   {0, 0, 0, 0}, {"occlusion", '=', 1},                  {NULL, NULL, NULL, NULL}},
    {"level",         LAO_FORMAT_R32UI,   LAO_SIZE_FULL, 0, 0, "levels", 0,                LAO_ENCODING_LEVEL,   {0, 0, 0, 0}, {"occlusion", '=', 1},                  {"axial%d.C", "axial%d.S", "axial%d.D", NULL}},
    {"level_tangent", LAO_FORMAT_RGBA8,   LAO_SIZE_FULL, 0, 0, "levels", 0,                LAO_ENCODING_SIGNED8, {LAO__UNKNOWN, LAO__UNKNOWN, LAO__UNKNOWN, LAO__UNKNOWN}, {"light", '=', LAO_LIGHT_AUTHOR},       {NULL, NULL, NULL, NULL}},
    {"ao",            LAO_FORMAT_R32F,    LAO_SIZE_FULL, 0, 0, NULL,     0,                LAO_ENCODING_PLAIN,   {0, 0, 0, 0}, {"occlusion", '=', 1},                  {"ao.V", NULL, NULL, NULL}},
    {"shaded",        LAO_FORMAT_RGBA8,   LAO_SIZE_FULL, 0, 0, NULL,     0,                LAO_ENCODING_PLAIN,   {0, 0, 0, 0}, LAO__ANY,                               {NULL, NULL, NULL, NULL}},
    {"out",           LAO_FORMAT_RGBA8,   LAO_SIZE_VIEW, 0, 0, NULL,     0,                LAO_ENCODING_PLAIN,   {0, 0, 0, 0}, LAO__ANY,                               {"out.R", "out.G", "out.B", "out.A"}}
};

static const lao_pass_row lao__passes[] = {
    /* the host's depth, so that its objects hide our lines */
    {"import_depth", LAO_PASS_FULLSCREEN, "import_depth", 0, LAO_STAGE_DRAW, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_ALWAYS, LAO_CULL_NONE, {{"@host_depth", '>', 0}},
     {LAO__WRITE("zbuffer")}, {LAO__READ("host_depth")}},
    /* G-buffer: colour and mask, tangent and zoom, linear depth (METHODS 1.1). One row of four draws a set: what the fragments need to know of the line's
       outline or of a fade costs where there is none, and who writes depth is tested late */
    {"lines", LAO_PASS_DRAW_LINES_FIRST, "lines", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {LAO__LINES, {"halo", '=', LAO_HALO_NONE}, {"trail", '!', LAO_TRAIL_OPACITY}},
     {LAO__CLEAR("color"), LAO__CLEAR("tangent"), LAO__CLEAR("depth"), LAO__KEEP("zbuffer")}, {LAO__READ("#points"), LAO__READ("#colors"), LAO__READ("#order")}},
    {"lines_fading", LAO_PASS_DRAW_LINES_FIRST, "lines_rim", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {LAO__LINES, {"halo", '=', LAO_HALO_NONE}, {"trail", '=', LAO_TRAIL_OPACITY}},
     {LAO__CLEAR("color"), LAO__CLEAR("tangent"), LAO__CLEAR("depth"), LAO__KEEP("zbuffer")}, {LAO__READ("#points"), LAO__READ("#colors"), LAO__READ("#order")}},
    {"lines_rim", LAO_PASS_DRAW_LINES_FIRST, "lines_rim", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {LAO__LINES, {"halo", '=', LAO_HALO_UNIFORM}},
     {LAO__CLEAR("color"), LAO__CLEAR("tangent"), LAO__CLEAR("depth"), LAO__KEEP("zbuffer")}, {LAO__READ("#points"), LAO__READ("#colors"), LAO__READ("#order")}},
    {"lines_halo", LAO_PASS_DRAW_LINES_FIRST, "lines_halo", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {LAO__LINES, {"halo", '=', LAO_HALO_DEPTH}},
     {LAO__CLEAR("color"), LAO__CLEAR("tangent"), LAO__CLEAR("depth"), LAO__KEEP("zbuffer")}, {LAO__READ("#points"), LAO__READ("#colors"), LAO__READ("#order")}},
    /* of many lines a part is drawn first; of each further part only what does not lie wholly behind the farthest depth around it */
    {"far_tiles", LAO_PASS_FULLSCREEN, "far", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_COUNT, "cull_hidden", LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {LAO__LINES, {"cull_hidden", '>', 0}, {"@color", '=', 0}},
     {LAO__WRITE_LEVEL("far_tiles", 2)}, {LAO__READ("zbuffer")}},
    {"far", LAO_PASS_FULLSCREEN, "far", 1, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_WITH_LAST, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {LAO__LINES, {"cull_hidden", '>', 0}, {"@color", '=', 0}},
     {LAO__WRITE_LEVEL("far", 2)}, {LAO__READ_LEVEL("far_tiles", 2)}},
    {"lines_rest", LAO_PASS_DRAW_LINES_REST, "lines", 1, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_WITH_LAST, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {LAO__LINES, {"cull_hidden", '>', 0}, {"halo", '=', LAO_HALO_NONE}},
     {LAO__KEEP("color"), LAO__KEEP("tangent"), LAO__KEEP("depth"), LAO__KEEP("zbuffer")}, {LAO__READ("#points"), LAO__READ("#colors"), LAO__READ("#order"), LAO__READ_LEVEL("far", 2)}},
    {"lines_rim_rest", LAO_PASS_DRAW_LINES_REST, "lines_rim", 1, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_WITH_LAST, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {LAO__LINES, {"cull_hidden", '>', 0}, {"halo", '=', LAO_HALO_UNIFORM}},
     {LAO__KEEP("color"), LAO__KEEP("tangent"), LAO__KEEP("depth"), LAO__KEEP("zbuffer")}, {LAO__READ("#points"), LAO__READ("#colors"), LAO__READ("#order"), LAO__READ_LEVEL("far", 2)}},
    {"lines_halo_rest", LAO_PASS_DRAW_LINES_REST, "lines_halo", 1, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_WITH_LAST, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {LAO__LINES, {"cull_hidden", '>', 0}, {"halo", '=', LAO_HALO_DEPTH}},
     {LAO__KEEP("color"), LAO__KEEP("tangent"), LAO__KEEP("depth"), LAO__KEEP("zbuffer")}, {LAO__READ("#points"), LAO__READ("#colors"), LAO__READ("#order"), LAO__READ_LEVEL("far", 2)}},
    /* the host's G-buffer instead of our lines: its mask as depth, for the passes that skip background by it */
    {"cover", LAO_PASS_FULLSCREEN, "cover", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_ALWAYS, LAO_CULL_NONE, {{"@color", '>', 0}},
     {LAO__CLEAR("zbuffer")}, {LAO__READ("color")}},
    /* level 0 of what a sample reads */
    {"level_zero", LAO_PASS_FULLSCREEN, "level_zero", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_COVERED, LAO_CULL_NONE, {LAO__LINES, {"occlusion", '=', 1}},
     {LAO__CLEAR("level"), LAO__CLEAR("level_tangent"), LAO__KEEP("zbuffer")},
     {LAO__READ("color"), LAO__READ("tangent"), LAO__READ("depth")}},
    /* coarser levels, and from level 1 on the sums that the next one is made of */
    {"level_one", LAO_PASS_FULLSCREEN, "level_one", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {LAO__LINES, {"occlusion", '=', 1}, {"levels", '>', 1}},
     {LAO__WRITE_LEVEL("tensor", 1), LAO__WRITE_LEVEL("level", 1), LAO__WRITE_LEVEL("level_tangent", 1)},
     {LAO__READ_LEVEL("level", 0), LAO__READ_LEVEL("level_tangent", 0)}},
    {"level_up", LAO_PASS_FULLSCREEN, "level_up", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_UP, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {LAO__LINES, {"occlusion", '=', 1}},
     {LAO__WRITE_ABOVE("tensor", 1), LAO__WRITE("level"), LAO__WRITE("level_tangent")},
     {LAO__READ_FINER("tensor"), LAO__READ_FINER("level_tangent")}},
    {"occlusion", LAO_PASS_FULLSCREEN, "occlusion", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_COVERED, LAO_CULL_NONE, {LAO__LINES, {"occlusion", '=', 1}},
     {LAO__CLEAR("ao"), LAO__KEEP("zbuffer")},
     {LAO__READ("tangent"), LAO__READ_ALL("level"), LAO__READ_COARSE("level_tangent")}},
    /* for debugging only: shadows leak into what is not shadowed (Koehler 2017, 4.4) */
    {"smooth_x", LAO_PASS_FULLSCREEN, "smooth", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_COUNT, "smoothing", LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {LAO__LINES, {"occlusion", '=', 1}},
     {LAO__OTHER("ao")}, {LAO__READ("ao"), LAO__READ("color")}},
    {"smooth_y", LAO_PASS_FULLSCREEN, "smooth", 1, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_COUNT, "smoothing", LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {LAO__LINES, {"occlusion", '=', 1}},
     {LAO__OTHER("ao")}, {LAO__READ("ao"), LAO__READ("color")}},
    {"shade", LAO_PASS_FULLSCREEN, "shade", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_COVERED, LAO_CULL_NONE, {LAO__LINES},
     {LAO__KEEP("shaded"), LAO__KEEP("zbuffer")}, {LAO__READ("color"), LAO__READ("tangent"), LAO__READ("ao")}},
    /* box filter over the samples of a pixel, and the background */
    {"resolve", LAO_PASS_FULLSCREEN, "resolve", 0, LAO_STAGE_PRESENT, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, LAO__ALWAYS,
     {LAO__WRITE("out")}, {LAO__READ("shaded")}},
    {"present", LAO_PASS_FULLSCREEN, "present", 0, LAO_STAGE_PRESENT, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_OVER, LAO_DEPTH_NONE, LAO_CULL_NONE, {{"@target", '>', 0}},
     {LAO__KEEP("target")}, {LAO__READ("out")}},
    {"export_depth", LAO_PASS_FULLSCREEN, "export_depth", 0, LAO_STAGE_PRESENT, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {{"@host_depth", '>', 1}},
     {LAO__KEEP("host_depth")}, {LAO__READ("zbuffer")}}
};

static const lao_setting_row lao__settings[] = {
#define LAO__ROW(name, type, minimum, maximum, standard, structural, unit, choices, help) \
    {#name, LAO_SETTING_##type, minimum, maximum, standard, structural, unit, choices, help},
    LAO_SETTINGS(LAO__ROW)
#undef LAO__ROW
};

static const lao_preset_row lao__presets[] = {
    {"classic", "align", LAO_ALIGN_NONE},
    {"classic", "strength", 1},
    {"classic", "halo", LAO_HALO_NONE},
    {"paper", "align", LAO_ALIGN_PAPER}
};

static const lao_buffer_row lao__buffers[] = {{"points", LAO_FORMAT_RGBA32F}, {"colors", LAO_FORMAT_RGBA8}, {"order", LAO_FORMAT_R32F}};

static const lao_module lao__lines_module = {
    "lines",
    lao__passes, (uint32_t)(sizeof lao__passes / sizeof lao__passes[0]),
    lao__images, (uint32_t)(sizeof lao__images / sizeof lao__images[0]),
    lao__settings, (uint32_t)(sizeof lao__settings / sizeof lao__settings[0]),
    lao__presets, (uint32_t)(sizeof lao__presets / sizeof lao__presets[0]),
    NULL, 0,
    lao__buffers, (uint32_t)(sizeof lao__buffers / sizeof lao__buffers[0])
};
// clang-format on

const lao_module *lao_lines_module(void) {
    return &lao__lines_module;
}

const lao_pass_row *lao_passes(int *count) {
    if (count) {
        *count = (int)lao__lines_module.pass_count;
    }
    return lao__passes;
}

const char *lao_result_text(lao_result result) {
    static const char *const text[] = {"done",
                                       "invalid argument",
                                       "stale handle",
                                       "out of memory",
                                       "out of device memory",
                                       "unsupported",
                                       "shader refused",
                                       "broken graph",
                                       "graphics library error",
                                       "device lost",
                                       "not ready"};
    return (uint32_t)result < sizeof text / sizeof text[0] ? text[result] : "unknown result";
}

uint32_t lao_format_bytes(lao_format format) {
    static const uint8_t bytes[LAO_FORMAT_COUNT] = {0, 4, 8, 16, 4, 4, 4, 0};
    return (uint32_t)format < LAO_FORMAT_COUNT ? bytes[format] : 0;
}
