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
#define LAO__NOTHING LAO_READ(NULL)
#define LAO__READ_COARSE(image) LAO_READ_LEVEL(image, 1), LAO_READ_LEVEL(image, 2), LAO_READ_LEVEL(image, 3), LAO_READ_LEVEL(image, 4), \
                                LAO_READ_LEVEL(image, 5), LAO_READ_LEVEL(image, 6), LAO_READ_LEVEL(image, 7)
#define LAO__READ_ALL(image) LAO_READ_LEVEL(image, 0), LAO__READ_COARSE(image)
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
     {LAO_WRITE("zbuffer")}, {LAO_READ("host_depth")}},
    /* G-buffer: colour and mask, tangent and zoom, linear depth (METHODS 1.1). One row of four draws a set: what the fragments need to know of the line's
       outline or of a fade costs where there is none, and who writes depth is tested late */
    {"lines", LAO_PASS_DRAW_LINES_FIRST, "lines", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {LAO__LINES, {"halo", '=', LAO_HALO_NONE}, {"trail", '!', LAO_TRAIL_OPACITY}},
     {LAO_WRITE_CLEARED("color"), LAO_WRITE_CLEARED("tangent"), LAO_WRITE_CLEARED("depth"), LAO_WRITE_KEPT("zbuffer")}, {LAO_READ("#points"), LAO_READ("#colors"), LAO_READ("#order")}},
    {"lines_fading", LAO_PASS_DRAW_LINES_FIRST, "lines_rim", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {LAO__LINES, {"halo", '=', LAO_HALO_NONE}, {"trail", '=', LAO_TRAIL_OPACITY}},
     {LAO_WRITE_CLEARED("color"), LAO_WRITE_CLEARED("tangent"), LAO_WRITE_CLEARED("depth"), LAO_WRITE_KEPT("zbuffer")}, {LAO_READ("#points"), LAO_READ("#colors"), LAO_READ("#order")}},
    {"lines_rim", LAO_PASS_DRAW_LINES_FIRST, "lines_rim", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {LAO__LINES, {"halo", '=', LAO_HALO_UNIFORM}},
     {LAO_WRITE_CLEARED("color"), LAO_WRITE_CLEARED("tangent"), LAO_WRITE_CLEARED("depth"), LAO_WRITE_KEPT("zbuffer")}, {LAO_READ("#points"), LAO_READ("#colors"), LAO_READ("#order")}},
    {"lines_halo", LAO_PASS_DRAW_LINES_FIRST, "lines_halo", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {LAO__LINES, {"halo", '=', LAO_HALO_DEPTH}},
     {LAO_WRITE_CLEARED("color"), LAO_WRITE_CLEARED("tangent"), LAO_WRITE_CLEARED("depth"), LAO_WRITE_KEPT("zbuffer")}, {LAO_READ("#points"), LAO_READ("#colors"), LAO_READ("#order")}},
    /* of many lines a part is drawn first; of each further part only what does not lie wholly behind the farthest depth around it */
    {"far_tiles", LAO_PASS_FULLSCREEN, "far", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_COUNT, "cull_hidden", LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {LAO__LINES, {"cull_hidden", '>', 0}, {"@color", '=', 0}},
     {LAO_WRITE_LEVEL("far_tiles", 2)}, {LAO_READ("zbuffer")}},
    {"far", LAO_PASS_FULLSCREEN, "far", 1, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_WITH_LAST, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {LAO__LINES, {"cull_hidden", '>', 0}, {"@color", '=', 0}},
     {LAO_WRITE_LEVEL("far", 2)}, {LAO_READ_LEVEL("far_tiles", 2)}},
    {"lines_rest", LAO_PASS_DRAW_LINES_REST, "lines", 1, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_WITH_LAST, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {LAO__LINES, {"cull_hidden", '>', 0}, {"halo", '=', LAO_HALO_NONE}},
     {LAO_WRITE_KEPT("color"), LAO_WRITE_KEPT("tangent"), LAO_WRITE_KEPT("depth"), LAO_WRITE_KEPT("zbuffer")}, {LAO_READ("#points"), LAO_READ("#colors"), LAO_READ("#order"), LAO_READ_LEVEL("far", 2)}},
    {"lines_rim_rest", LAO_PASS_DRAW_LINES_REST, "lines_rim", 1, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_WITH_LAST, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {LAO__LINES, {"cull_hidden", '>', 0}, {"halo", '=', LAO_HALO_UNIFORM}},
     {LAO_WRITE_KEPT("color"), LAO_WRITE_KEPT("tangent"), LAO_WRITE_KEPT("depth"), LAO_WRITE_KEPT("zbuffer")}, {LAO_READ("#points"), LAO_READ("#colors"), LAO_READ("#order"), LAO_READ_LEVEL("far", 2)}},
    {"lines_halo_rest", LAO_PASS_DRAW_LINES_REST, "lines_halo", 1, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_WITH_LAST, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {LAO__LINES, {"cull_hidden", '>', 0}, {"halo", '=', LAO_HALO_DEPTH}},
     {LAO_WRITE_KEPT("color"), LAO_WRITE_KEPT("tangent"), LAO_WRITE_KEPT("depth"), LAO_WRITE_KEPT("zbuffer")}, {LAO_READ("#points"), LAO_READ("#colors"), LAO_READ("#order"), LAO_READ_LEVEL("far", 2)}},
    /* the host's G-buffer instead of our lines: its mask as depth, for the passes that skip background by it */
    {"cover", LAO_PASS_FULLSCREEN, "cover", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_ALWAYS, LAO_CULL_NONE, {{"@color", '>', 0}},
     {LAO_WRITE_CLEARED("zbuffer")}, {LAO_READ("color")}},
    /* level 0 of what a sample reads */
    {"level_zero", LAO_PASS_FULLSCREEN, "level_zero", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_COVERED, LAO_CULL_NONE, {LAO__LINES, {"occlusion", '=', 1}},
     {LAO_WRITE_CLEARED("level"), LAO_WRITE_CLEARED("level_tangent"), LAO_WRITE_KEPT("zbuffer")},
     {LAO_READ("color"), LAO_READ("tangent"), LAO_READ("depth")}},
    /* coarser levels, and from level 1 on the sums that the next one is made of */
    {"level_one", LAO_PASS_FULLSCREEN, "level_one", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {LAO__LINES, {"occlusion", '=', 1}, {"levels", '>', 1}},
     {LAO_WRITE_LEVEL("tensor", 1), LAO_WRITE_LEVEL("level", 1), LAO_WRITE_LEVEL("level_tangent", 1)},
     {LAO_READ_LEVEL("level", 0), LAO_READ_LEVEL("level_tangent", 0)}},
    {"level_up", LAO_PASS_FULLSCREEN, "level_up", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_UP, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {LAO__LINES, {"occlusion", '=', 1}},
     {LAO_WRITE_ABOVE("tensor", 1), LAO_WRITE("level"), LAO_WRITE("level_tangent")},
     {LAO_READ_FINER("tensor"), LAO_READ_FINER("level_tangent")}},
    {"occlusion", LAO_PASS_FULLSCREEN, "occlusion", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_COVERED, LAO_CULL_NONE, {LAO__LINES, {"occlusion", '=', 1}},
     {LAO_WRITE_CLEARED("ao"), LAO_WRITE_KEPT("zbuffer")},
     {LAO_READ("tangent"), LAO__READ_ALL("level"), LAO__READ_COARSE("level_tangent")}},
    /* for debugging only: shadows leak into what is not shadowed (Koehler 2017, 4.4) */
    {"smooth_x", LAO_PASS_FULLSCREEN, "smooth", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_COUNT, "smoothing", LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {LAO__LINES, {"occlusion", '=', 1}},
     {LAO_WRITE_OTHER("ao")}, {LAO_READ("ao"), LAO_READ("color")}},
    {"smooth_y", LAO_PASS_FULLSCREEN, "smooth", 1, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_COUNT, "smoothing", LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {LAO__LINES, {"occlusion", '=', 1}},
     {LAO_WRITE_OTHER("ao")}, {LAO_READ("ao"), LAO_READ("color")}},
    {"shade", LAO_PASS_FULLSCREEN, "shade", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_COVERED, LAO_CULL_NONE, {LAO__LINES},
     {LAO_WRITE_KEPT("shaded"), LAO_WRITE_KEPT("zbuffer")}, {LAO_READ("color"), LAO_READ("tangent"), LAO_READ("ao")}},
    /* box filter over the samples of a pixel, and the background */
    {"resolve", LAO_PASS_FULLSCREEN, "resolve", 0, LAO_STAGE_PRESENT, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, LAO__ALWAYS,
     {LAO_WRITE("out")}, {LAO_READ("shaded")}},
    {"present", LAO_PASS_FULLSCREEN, "present", 0, LAO_STAGE_PRESENT, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_OVER, LAO_DEPTH_NONE, LAO_CULL_NONE, {{"@target", '>', 0}},
     {LAO_WRITE_KEPT("target")}, {LAO_READ("out")}},
    {"export_depth", LAO_PASS_FULLSCREEN, "export_depth", 0, LAO_STAGE_PRESENT, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {{"@host_depth", '>', 1}},
     {LAO_WRITE_KEPT("host_depth")}, {LAO_READ("zbuffer")}}
};

static const lao_setting_row lao__settings[] = {
    LAO_SETTINGS(LAO_SETTING_ROW)
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
