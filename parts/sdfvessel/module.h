/* ================================================================================================
 * module: passes, images, buffers and settings, as tables. Uses no other section. */
// clang-format off
#define SDV__TOP(image) LAO_WRITE_LEVEL(image, 31)
#define SDV__BACKGROUND {"parameterization", '>', 0}
#define SDV__PARAMETERIZED {"parameterization", '>', 1}
#define SDV__WITH_BACKGROUND {{"#vessel_box", '>', 0}, SDV__BACKGROUND}
#define SDV__WITH_PHASES {{"#vessel_box", '>', 0}, SDV__PARAMETERIZED}
/* a tree, one with shapes, and what is only seen: a mesh, a surface that the host drew */
#define SDV__TREE {"#vessel_cones", '>', 0}, {"#vessel_shapes", '=', 0}
#define SDV__SHAPES {"#vessel_cones", '>', 0}, {"#vessel_shapes", '>', 0}
#define SDV__SEEN {"#vessel_box", '>', 0}, {"#vessel_cones", '=', 0}
#define SDV__DRAWN {SDV__SEEN, {"#vessel_triangles", '=', 0}}
#define SDV__WITH_TREE {SDV__TREE}
#define SDV__WITH_SHAPES {SDV__SHAPES}
/* sdv_object_make_tree: the object has no cells of its own */
#define SDV__BY_DEVICE {"#vessel_cells", '=', 0}
#define SDV__WITH_CONES_ONLY {{"#vessel_cones", '>', 0}, SDV__BY_DEVICE}

static const lao_buffer_row sdv__buffers[] = {
    {"vessel_box", LAO_FORMAT_RGBA32F}, {"vessel_cells", LAO_FORMAT_RGBA32F}, {"vessel_ids", LAO_FORMAT_R32F},
    {"vessel_cones", LAO_FORMAT_RGBA32F}, {"vessel_forms", LAO_FORMAT_RGBA32F}, {"vessel_colors", LAO_FORMAT_RGBA8},
    {"vessel_shapes", LAO_FORMAT_RGBA32F}, {"vessel_fields", LAO_FORMAT_R32F},
    {"vessel_vertices", LAO_FORMAT_RGBA32F}, {"vessel_triangles", LAO_FORMAT_RGBA32F},
    {"vessel_pattern", LAO_FORMAT_R32F}
};

/* Kinds of items of the images below: lao_object_desc.further_items[kind - 1]. */
enum {
    SDV__CELLS = 1, SDV__REGION_PARTS, SDV__REGION_ENTRIES, SDV__BLOCK_PARTS, SDV__BLOCK_ENTRIES, SDV__ENTRIES, SDV__WORDS
};

static const lao_image_row sdv__images[] = {
    /* the field that the device builds; of pyramids of sums, levels down to one texel */
    {"vessel_region_counts", LAO_FORMAT_R32F, LAO_SIZE_ITEMS, SDV__REGION_PARTS, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_region_masks", LAO_FORMAT_R32UI, LAO_SIZE_ITEMS, SDV__REGION_PARTS, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_region_starts", LAO_FORMAT_R32F, LAO_SIZE_ITEMS, SDV__REGION_PARTS, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_region_cones", LAO_FORMAT_R32F, LAO_SIZE_ITEMS, SDV__REGION_ENTRIES, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_block_counts", LAO_FORMAT_R32F, LAO_SIZE_ITEMS, SDV__BLOCK_PARTS, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_block_masks", LAO_FORMAT_R32UI, LAO_SIZE_ITEMS, SDV__BLOCK_PARTS, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_block_starts", LAO_FORMAT_R32F, LAO_SIZE_ITEMS, SDV__BLOCK_PARTS, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_block_cones", LAO_FORMAT_R32F, LAO_SIZE_ITEMS, SDV__BLOCK_ENTRIES, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_counts", LAO_FORMAT_R32F, LAO_SIZE_ITEMS, SDV__CELLS, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_masks", LAO_FORMAT_R32UI, LAO_SIZE_ITEMS, SDV__CELLS, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_starts", LAO_FORMAT_R32F, LAO_SIZE_ITEMS, SDV__CELLS, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_lists", LAO_FORMAT_R32F, LAO_SIZE_ITEMS, SDV__ENTRIES, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_words", LAO_FORMAT_R32UI, LAO_SIZE_ITEMS, SDV__WORDS, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_nearest_x", LAO_FORMAT_R32F, LAO_SIZE_ITEMS, SDV__CELLS, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_nearest_xy", LAO_FORMAT_R32F, LAO_SIZE_ITEMS, SDV__CELLS, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_grid", LAO_FORMAT_RGBA32F, LAO_SIZE_ITEMS, SDV__CELLS, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BY_DEVICE, {NULL, NULL, NULL, NULL}},
    {"vessel_position", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, -1}, {NULL, 0, 0}, {"position.X", "position.Y", "position.Z", "segment.V"}},
    {"vessel_normal",   LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0},  {NULL, 0, 0}, {"normal.X", "normal.Y", "normal.Z", "dmin.V"}},
    {"vessel_ray",      LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0},  {NULL, 0, 0}, {NULL, NULL, NULL, NULL}},
    {"vessel_color",    LAO_FORMAT_RGBA8,   LAO_SIZE_FULL, 0, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0},  {NULL, 0, 0}, {NULL, NULL, NULL, NULL}},
    {"vessel_direction", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {"guide", '>', 0}, {NULL, NULL, NULL, NULL}},
    {"vessel_drawn_depth", LAO_FORMAT_HOST, LAO_SIZE_FULL, 0, 0, NULL, LAO_IMAGE_IMPORT, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {NULL, 0, 0}, {NULL, NULL, NULL, NULL}},
    {"vessel_z",        LAO_FORMAT_D32F,    LAO_SIZE_FULL, 0, 0, NULL, 0, LAO_ENCODING_PLAIN, {1, 0, 0, 0},  {NULL, 0, 0}, {NULL, NULL, NULL, NULL}},
    /* where there is a parameterization: of pyramids, levels down to one texel; what each holds stands in its shader */
    {"vessel_depth", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BACKGROUND, {NULL, NULL, NULL, NULL}},
    {"vessel_filled", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BACKGROUND, {NULL, NULL, NULL, NULL}},
    {"vessel_surface", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, NULL, LAO_IMAGE_HISTORY, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BACKGROUND, {"bgposition.X", "bgposition.Y", "bgposition.Z", NULL}},
    {"vessel_bgnormal", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__BACKGROUND, {"bgnormal.X", "bgnormal.Y", "bgnormal.Z", NULL}},
    {"vessel_place", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__PARAMETERIZED, {NULL, NULL, NULL, NULL}},
    {"vessel_facing", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__PARAMETERIZED, {NULL, NULL, NULL, NULL}},
    {"vessel_tensor", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__PARAMETERIZED, {NULL, NULL, NULL, NULL}},
    {"vessel_spread", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__PARAMETERIZED, {NULL, NULL, NULL, NULL}},
    {"vessel_along", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__PARAMETERIZED, {NULL, NULL, NULL, NULL}},
    {"vessel_across", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__PARAMETERIZED, {NULL, NULL, NULL, NULL}},
    {"vessel_recalled", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__PARAMETERIZED, {NULL, NULL, NULL, NULL}},
    {"vessel_phase", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__PARAMETERIZED, {NULL, NULL, NULL, NULL}},
    {"vessel_uv", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, NULL, LAO_IMAGE_HISTORY, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, SDV__PARAMETERIZED, {"uv.U", "uv.V", "guide.X", "guide.Y"}},
    {"vessel_ink", LAO_FORMAT_RGBA32F, LAO_SIZE_FULL, 0, 0, NULL, LAO_IMAGE_HISTORY, LAO_ENCODING_PLAIN, {1, 0, 0, 0}, SDV__PARAMETERIZED, {NULL, NULL, NULL, NULL}}
};

static const lao_pass_row sdv__passes[] = {
    /* the field from cones alone: lists of regions, blocks and cells, then the nearest cell that has one */
    {"vessel_region_counts", LAO_PASS_FULLSCREEN, "vessel_lists", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {LAO_WRITE("vessel_region_counts"), LAO_WRITE("vessel_region_masks")},
     {LAO_READ("#vessel_box"), LAO_READ("#vessel_cones")}},
    {"vessel_region_sums", LAO_PASS_FULLSCREEN, "vessel_sum", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_UP, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {LAO_WRITE("vessel_region_counts")},
     {LAO_READ_FINER("vessel_region_counts")}},
    {"vessel_region_top", LAO_PASS_FULLSCREEN, "vessel_start", 1, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {SDV__TOP("vessel_region_starts")},
     {SDV__TOP("vessel_region_counts")}},
    {"vessel_region_starts", LAO_PASS_FULLSCREEN, "vessel_start", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_DOWN, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {LAO_WRITE("vessel_region_starts")},
     {LAO_READ_COARSER("vessel_region_starts"), LAO_READ("vessel_region_counts")}},
    {"vessel_region_cones", LAO_PASS_FULLSCREEN, "vessel_lists", 1, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {LAO_WRITE("vessel_region_cones")},
     {LAO_READ("#vessel_box"), LAO_READ("#vessel_cones"), LAO_READ("vessel_region_starts"), LAO_READ("vessel_region_starts"), LAO_READ("vessel_region_starts"), LAO_READ("vessel_region_masks")}},
    {"vessel_block_counts", LAO_PASS_FULLSCREEN, "vessel_lists", 2, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {LAO_WRITE("vessel_block_counts"), LAO_WRITE("vessel_block_masks")},
     {LAO_READ("#vessel_box"), LAO_READ("#vessel_cones"), LAO_READ("vessel_region_starts"), LAO_READ("vessel_region_cones")}},
    {"vessel_block_sums", LAO_PASS_FULLSCREEN, "vessel_sum", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_UP, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {LAO_WRITE("vessel_block_counts")},
     {LAO_READ_FINER("vessel_block_counts")}},
    {"vessel_block_top", LAO_PASS_FULLSCREEN, "vessel_start", 1, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {SDV__TOP("vessel_block_starts")},
     {SDV__TOP("vessel_block_counts")}},
    {"vessel_block_starts", LAO_PASS_FULLSCREEN, "vessel_start", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_DOWN, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {LAO_WRITE("vessel_block_starts")},
     {LAO_READ_COARSER("vessel_block_starts"), LAO_READ("vessel_block_counts")}},
    {"vessel_block_cones", LAO_PASS_FULLSCREEN, "vessel_lists", 3, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {LAO_WRITE("vessel_block_cones")},
     {LAO_READ("#vessel_box"), LAO_READ("#vessel_cones"), LAO_READ("vessel_region_starts"), LAO_READ("vessel_region_cones"), LAO_READ("vessel_block_starts"), LAO_READ("vessel_block_masks")}},
    {"vessel_counts", LAO_PASS_FULLSCREEN, "vessel_lists", 4, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {LAO_WRITE("vessel_counts"), LAO_WRITE("vessel_masks")},
     {LAO_READ("#vessel_box"), LAO_READ("#vessel_cones"), LAO_READ("vessel_block_starts"), LAO_READ("vessel_block_cones")}},
    {"vessel_sums", LAO_PASS_FULLSCREEN, "vessel_sum", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_UP, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {LAO_WRITE("vessel_counts")},
     {LAO_READ_FINER("vessel_counts")}},
    {"vessel_top", LAO_PASS_FULLSCREEN, "vessel_start", 1, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {SDV__TOP("vessel_starts")},
     {SDV__TOP("vessel_counts")}},
    {"vessel_starts", LAO_PASS_FULLSCREEN, "vessel_start", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_DOWN, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {LAO_WRITE("vessel_starts")},
     {LAO_READ_COARSER("vessel_starts"), LAO_READ("vessel_counts")}},
    {"vessel_lists", LAO_PASS_FULLSCREEN, "vessel_lists", 5, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {LAO_WRITE("vessel_lists")},
     {LAO_READ("#vessel_box"), LAO_READ("#vessel_cones"), LAO_READ("vessel_block_starts"), LAO_READ("vessel_block_cones"), LAO_READ("vessel_starts"), LAO_READ("vessel_masks")}},
    {"vessel_words", LAO_PASS_FULLSCREEN, "vessel_words", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {LAO_WRITE("vessel_words")},
     {LAO_READ("#vessel_box"), LAO_READ("vessel_counts")}},
    {"vessel_rows", LAO_PASS_FULLSCREEN, "vessel_rows", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {LAO_WRITE("vessel_nearest_x")},
     {LAO_READ("#vessel_box"), LAO_READ("vessel_words")}},
    {"vessel_columns", LAO_PASS_FULLSCREEN, "vessel_columns", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {LAO_WRITE("vessel_nearest_xy")},
     {LAO_READ("#vessel_box"), LAO_READ("vessel_nearest_x")}},
    {"vessel_grid", LAO_PASS_FULLSCREEN, "vessel_grid", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_CONES_ONLY,
     {LAO_WRITE("vessel_grid")},
     {LAO_READ("#vessel_box"), LAO_READ("#vessel_cones"), LAO_READ("vessel_counts"), LAO_READ("vessel_starts"), LAO_READ("vessel_lists"), LAO_READ("vessel_nearest_xy")}},
    {"vessel_trace", LAO_PASS_FULLSCREEN, "vessel_trace", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_TREE,
     {LAO_WRITE("vessel_position"), LAO_WRITE("vessel_normal"), LAO_WRITE("vessel_ray")},
     {LAO_READ("#vessel_box"), LAO_READ("#vessel_cells"), LAO_READ("#vessel_ids"), LAO_READ("#vessel_cones"), LAO_READ("vessel_grid"), LAO_READ("vessel_lists")}},
    {"vessel_carve", LAO_PASS_FULLSCREEN, "vessel_carve", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_SHAPES,
     {LAO_WRITE("vessel_position"), LAO_WRITE("vessel_normal"), LAO_WRITE("vessel_ray")},
     {LAO_READ("#vessel_box"), LAO_READ("#vessel_cells"), LAO_READ("#vessel_ids"), LAO_READ("#vessel_cones"), LAO_READ("#vessel_shapes"), LAO_READ("#vessel_fields"), LAO_READ("vessel_grid"), LAO_READ("vessel_lists")}},
    {"vessel_mesh", LAO_PASS_DRAW_MESH, "vessel_mesh", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {{"#vessel_triangles", '>', 0}},
     {LAO_WRITE_CLEARED("vessel_position"), LAO_WRITE_CLEARED("vessel_normal"), LAO_WRITE_CLEARED("vessel_color"), LAO_WRITE_CLEARED("vessel_direction"), LAO_WRITE_CLEARED("vessel_z")},
     {LAO_READ("#vessel_vertices"), LAO_READ("#vessel_triangles"), LAO_READ("#vessel_colors")}},
    /* of a surface that the host drew what it does not bring itself */
    {"vessel_drawn_place", LAO_PASS_FULLSCREEN, "vessel_drawn", 0, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__DRAWN,
     {LAO_WRITE("vessel_position")},
     {LAO_READ("vessel_drawn_depth")}},
    {"vessel_drawn_normal", LAO_PASS_FULLSCREEN, "vessel_drawn", 1, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__DRAWN,
     {LAO_WRITE("vessel_normal")},
     {LAO_READ("vessel_position")}},
    {"vessel_drawn_color", LAO_PASS_FULLSCREEN, "vessel_drawn", 2, LAO_STAGE_DRAW, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__DRAWN,
     {LAO_WRITE("vessel_color")},
     {LAO_READ("vessel_position")}},
    /* the void: depth pulled up and pushed down, then a place and a normal for every pixel (L19 3.4) */
    {"vessel_depth", LAO_PASS_FULLSCREEN, "vessel_depth", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_BACKGROUND,
     {LAO_WRITE("vessel_depth")},
     {LAO_READ("vessel_position"), LAO_READ_PREVIOUS("vessel_surface")}},
    {"vessel_depth_up", LAO_PASS_FULLSCREEN, "vessel_pull", SDV_PULL_MEAN, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_UP, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_BACKGROUND,
     {LAO_WRITE("vessel_depth")},
     {LAO_READ_FINER("vessel_depth")}},
    {"vessel_fill_top", LAO_PASS_FULLSCREEN, "vessel_fill", 1, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_BACKGROUND,
     {SDV__TOP("vessel_filled")},
     {SDV__TOP("vessel_depth"), SDV__TOP("vessel_depth")}},
    {"vessel_fill", LAO_PASS_FULLSCREEN, "vessel_fill", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_DOWN, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_BACKGROUND,
     {LAO_WRITE("vessel_filled")},
     {LAO_READ("vessel_depth"), LAO_READ_COARSER("vessel_filled")}},
    {"vessel_surface", LAO_PASS_FULLSCREEN, "vessel_surface", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {{"#vessel_cones", '>', 0}, SDV__BACKGROUND},
     {LAO_WRITE("vessel_surface"), LAO_WRITE("vessel_bgnormal"), LAO_WRITE("vessel_place"), LAO_WRITE("vessel_facing"), LAO_WRITE("vessel_tensor")},
     {LAO_READ("vessel_filled"), LAO_READ("vessel_depth"), LAO_READ("vessel_position"), LAO_READ("vessel_normal"), LAO_READ("#vessel_cones"), LAO_READ("vessel_normal")}},
    {"vessel_surface_seen", LAO_PASS_FULLSCREEN, "vessel_surface", 1, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {SDV__SEEN, SDV__BACKGROUND},
     {LAO_WRITE("vessel_surface"), LAO_WRITE("vessel_bgnormal"), LAO_WRITE("vessel_place"), LAO_WRITE("vessel_facing"), LAO_WRITE("vessel_tensor")},
     {LAO_READ("vessel_filled"), LAO_READ("vessel_depth"), LAO_READ("vessel_position"), LAO_READ("vessel_normal"), LAO_READ("#vessel_cones"), LAO_READ("vessel_direction")}},
    /* the guiding field of the contours (L19 3.5) */
    {"vessel_place_up", LAO_PASS_FULLSCREEN, "vessel_gather", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_UP, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_PHASES,
     {LAO_WRITE("vessel_place"), LAO_WRITE("vessel_facing")},
     {LAO_READ_FINER("vessel_place"), LAO_READ_FINER("vessel_facing")}},
    {"vessel_tensor_up", LAO_PASS_FULLSCREEN, "vessel_pull", SDV_PULL_SUM, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_UP, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_PHASES,
     {LAO_WRITE("vessel_tensor")},
     {LAO_READ_FINER("vessel_tensor")}},
    {"vessel_guide_top", LAO_PASS_FULLSCREEN, "vessel_guide", 1, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_PHASES,
     {SDV__TOP("vessel_spread"), SDV__TOP("vessel_along"), SDV__TOP("vessel_across")},
     {SDV__TOP("vessel_tensor"), SDV__TOP("vessel_place"), SDV__TOP("vessel_facing"), SDV__TOP("vessel_tensor"), SDV__TOP("vessel_place"), SDV__TOP("vessel_facing")}},
    {"vessel_guide", LAO_PASS_FULLSCREEN, "vessel_guide", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_DOWN, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_PHASES,
     {LAO_WRITE("vessel_spread"), LAO_WRITE("vessel_along"), LAO_WRITE("vessel_across")},
     {LAO_READ("vessel_tensor"), LAO_READ("vessel_place"), LAO_READ("vessel_facing"), LAO_READ_COARSER("vessel_spread"), LAO_READ_COARSER("vessel_place"), LAO_READ_COARSER("vessel_along")}},
    /* phases: the last frame's pulled up, then pushed down and optimised (L19 3.6, 3.7) */
    {"vessel_recall", LAO_PASS_FULLSCREEN, "vessel_recall", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_PHASES,
     {LAO_WRITE("vessel_recalled")},
     {LAO_READ("vessel_surface"), LAO_READ("vessel_bgnormal"), LAO_READ("vessel_along"), LAO_READ("vessel_across"), LAO_READ_PREVIOUS("vessel_surface"), LAO_READ_PREVIOUS("vessel_uv"), LAO_READ_PREVIOUS("vessel_ink")}},
    {"vessel_recall_up", LAO_PASS_FULLSCREEN, "vessel_recall_up", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_UP, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_PHASES,
     {LAO_WRITE("vessel_recalled")},
     {LAO_READ_FINER("vessel_recalled"), LAO_READ_FINER("vessel_place"), LAO_READ_FINER("vessel_along"), LAO_READ_FINER("vessel_across"), LAO_READ("vessel_place"), LAO_READ("vessel_along"), LAO_READ("vessel_across")}},
    {"vessel_phase_top", LAO_PASS_FULLSCREEN, "vessel_phase", 1, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_PHASES,
     {SDV__TOP("vessel_phase")},
     {SDV__TOP("vessel_recalled"), SDV__TOP("vessel_place"), SDV__TOP("vessel_along"), SDV__TOP("vessel_across"), SDV__TOP("vessel_place"), SDV__TOP("vessel_along"), SDV__TOP("vessel_across"), SDV__TOP("vessel_recalled")}},
    {"vessel_phase", LAO_PASS_FULLSCREEN, "vessel_phase", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_LEVELS_DOWN, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_PHASES,
     {LAO_WRITE("vessel_phase")},
     {LAO_READ("vessel_recalled"), LAO_READ("vessel_place"), LAO_READ("vessel_along"), LAO_READ("vessel_across"), LAO_READ_COARSER("vessel_place"), LAO_READ_COARSER("vessel_along"), LAO_READ_COARSER("vessel_across"), LAO_READ_COARSER("vessel_phase")}},
    {"vessel_sweep", LAO_PASS_FULLSCREEN, "vessel_sweep", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_WITH_LAST, "ssp_sweeps", LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_PHASES,
     {LAO_WRITE_OTHER("vessel_phase")},
     {LAO_READ("vessel_phase"), LAO_READ("vessel_place"), LAO_READ("vessel_along"), LAO_READ("vessel_across")}},
    {"vessel_uv", LAO_PASS_FULLSCREEN, "vessel_uv", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, SDV__WITH_PHASES,
     {LAO_WRITE("vessel_uv")},
     {LAO_READ("vessel_phase"), LAO_READ("vessel_spread"), LAO_READ("vessel_along"), LAO_READ("vessel_surface"), LAO_READ_PREVIOUS("vessel_surface"), LAO_READ_PREVIOUS("vessel_uv")}},
    /* strokes and dots, where phases changed faded over */
    {"vessel_ink", LAO_PASS_FULLSCREEN, "vessel_ink", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {SDV__TREE, SDV__PARAMETERIZED},
     {LAO_WRITE("vessel_ink")},
     {LAO_READ("vessel_surface"), LAO_READ("vessel_bgnormal"), LAO_READ("vessel_normal"), LAO_READ("vessel_ray"),
      LAO_READ("#vessel_box"), LAO_READ("#vessel_cells"), LAO_READ("#vessel_ids"), LAO_READ("#vessel_cones"),
      LAO_READ("#vessel_shapes"), LAO_READ("#vessel_fields"), LAO_READ("vessel_uv"), LAO_READ("vessel_recalled"),
      LAO_READ("#vessel_pattern"), LAO_READ("#vessel_colors"), LAO_READ("vessel_grid"), LAO_READ("vessel_lists")}},
    {"vessel_ink_cut", LAO_PASS_FULLSCREEN, "vessel_ink", 1, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {SDV__SHAPES, SDV__PARAMETERIZED},
     {LAO_WRITE("vessel_ink")},
     {LAO_READ("vessel_surface"), LAO_READ("vessel_bgnormal"), LAO_READ("vessel_normal"), LAO_READ("vessel_ray"),
      LAO_READ("#vessel_box"), LAO_READ("#vessel_cells"), LAO_READ("#vessel_ids"), LAO_READ("#vessel_cones"),
      LAO_READ("#vessel_shapes"), LAO_READ("#vessel_fields"), LAO_READ("vessel_uv"), LAO_READ("vessel_recalled"),
      LAO_READ("#vessel_pattern"), LAO_READ("#vessel_colors"), LAO_READ("vessel_grid"), LAO_READ("vessel_lists")}},
    {"vessel_ink_seen", LAO_PASS_FULLSCREEN, "vessel_ink", 2, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {SDV__SEEN, SDV__PARAMETERIZED},
     {LAO_WRITE("vessel_ink")},
     {LAO_READ("vessel_surface"), LAO_READ("vessel_bgnormal"), LAO_READ("vessel_normal"), LAO_READ("vessel_normal"),
      LAO_READ("#vessel_box"), LAO_READ("#vessel_cells"), LAO_READ("#vessel_ids"), LAO_READ("#vessel_cones"),
      LAO_READ("#vessel_shapes"), LAO_READ("#vessel_fields"), LAO_READ("vessel_uv"), LAO_READ("vessel_recalled"),
      LAO_READ("#vessel_pattern"), LAO_READ("#vessel_colors"), LAO_READ("vessel_normal"), LAO_READ("vessel_normal")}},
    {"vessel_shade", LAO_PASS_FULLSCREEN, "vessel_shade", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, SDV__WITH_TREE,
     {LAO_WRITE_KEPT("shaded"), LAO_WRITE_KEPT("zbuffer")},
     {LAO_READ("vessel_position"), LAO_READ("vessel_normal"), LAO_READ("vessel_ray"), LAO_READ("#vessel_colors"),
      LAO_READ("#vessel_box"), LAO_READ("#vessel_cells"), LAO_READ("#vessel_ids"), LAO_READ("#vessel_cones"),
      LAO_READ("#vessel_shapes"), LAO_READ("#vessel_fields"),
      LAO_READ("vessel_surface"), LAO_READ("vessel_bgnormal"), LAO_READ("vessel_ink"), LAO_READ("vessel_normal"), LAO_READ("vessel_grid"), LAO_READ("vessel_lists")}},
    {"vessel_shade_cut", LAO_PASS_FULLSCREEN, "vessel_shade", 1, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, SDV__WITH_SHAPES,
     {LAO_WRITE_KEPT("shaded"), LAO_WRITE_KEPT("zbuffer")},
     {LAO_READ("vessel_position"), LAO_READ("vessel_normal"), LAO_READ("vessel_ray"), LAO_READ("#vessel_colors"),
      LAO_READ("#vessel_box"), LAO_READ("#vessel_cells"), LAO_READ("#vessel_ids"), LAO_READ("#vessel_cones"),
      LAO_READ("#vessel_shapes"), LAO_READ("#vessel_fields"),
      LAO_READ("vessel_surface"), LAO_READ("vessel_bgnormal"), LAO_READ("vessel_ink"), LAO_READ("vessel_normal"), LAO_READ("vessel_grid"), LAO_READ("vessel_lists")}},
    {"vessel_shade_seen", LAO_PASS_FULLSCREEN, "vessel_shade", 2, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {SDV__SEEN},
     {LAO_WRITE_KEPT("shaded"), LAO_WRITE_KEPT("zbuffer")},
     {LAO_READ("vessel_position"), LAO_READ("vessel_normal"), LAO_READ("vessel_normal"), LAO_READ("#vessel_colors"),
      LAO_READ("#vessel_box"), LAO_READ("#vessel_cells"), LAO_READ("#vessel_ids"), LAO_READ("#vessel_cones"),
      LAO_READ("#vessel_shapes"), LAO_READ("#vessel_fields"),
      LAO_READ("vessel_surface"), LAO_READ("vessel_bgnormal"), LAO_READ("vessel_ink"), LAO_READ("vessel_color"), LAO_READ("vessel_normal"), LAO_READ("vessel_normal")}}
};

static const lao_setting_row sdv__settings[] = {
    SDV_SETTINGS(LAO_SETTING_ROW)
};

static const lao_module sdv__module = {
    "vessel",
    sdv__passes, (uint32_t)(sizeof sdv__passes / sizeof sdv__passes[0]),
    sdv__images, (uint32_t)(sizeof sdv__images / sizeof sdv__images[0]),
    sdv__settings, (uint32_t)(sizeof sdv__settings / sizeof sdv__settings[0]),
    NULL, 0, NULL, 0,
    sdv__buffers, (uint32_t)(sizeof sdv__buffers / sizeof sdv__buffers[0])
};
// clang-format on

/* ---- pull-push of a host's image */
// clang-format off
#define SDV__OF_HOST {"@pull_push_image", '>', 0}
static const lao_image_row sdv__pull_push_images[] = {
    {"pull_push_image",  LAO_FORMAT_HOST,    LAO_SIZE_VIEW, 0, 0, NULL, LAO_IMAGE_IMPORT, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {NULL, 0, 0}, {NULL, NULL, NULL, NULL}},
    {"pull_push_result", LAO_FORMAT_HOST,    LAO_SIZE_VIEW, 0, 0, NULL, LAO_IMAGE_IMPORT, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {NULL, 0, 0}, {NULL, NULL, NULL, NULL}},
    {"pull_push_level",  LAO_FORMAT_RGBA32F, LAO_SIZE_VIEW, 0, 0, "*",  0,                LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {NULL, 0, 0}, {NULL, NULL, NULL, NULL}},
    {"pull_push_filled", LAO_FORMAT_RGBA32F, LAO_SIZE_VIEW, 0, 0, "*",  0,                LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {NULL, 0, 0}, {NULL, NULL, NULL, NULL}}
};
static const lao_pass_row sdv__pull_push_passes[] = {
    {"pull_push_start", LAO_PASS_FULLSCREEN, "vessel_push", 2, LAO_STAGE_DRAW, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {SDV__OF_HOST},
     {LAO_WRITE("pull_push_level")},
     {LAO_READ("pull_push_image"), LAO_READ("pull_push_image")}},
    {"pull_push_mean", LAO_PASS_FULLSCREEN, "vessel_pull", SDV_PULL_MEAN, LAO_STAGE_DRAW, LAO_SCOPE_FRAME, LAO_REPEAT_LEVELS_UP, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {SDV__OF_HOST, {"pull", '=', SDV_PULL_MEAN}},
     {LAO_WRITE("pull_push_level")},
     {LAO_READ_FINER("pull_push_level")}},
    {"pull_push_sum", LAO_PASS_FULLSCREEN, "vessel_pull", SDV_PULL_SUM, LAO_STAGE_DRAW, LAO_SCOPE_FRAME, LAO_REPEAT_LEVELS_UP, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {SDV__OF_HOST, {"pull", '=', SDV_PULL_SUM}},
     {LAO_WRITE("pull_push_level")},
     {LAO_READ_FINER("pull_push_level")}},
    {"pull_push_top", LAO_PASS_FULLSCREEN, "vessel_push", 1, LAO_STAGE_DRAW, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {SDV__OF_HOST},
     {SDV__TOP("pull_push_filled")},
     {SDV__TOP("pull_push_level"), SDV__TOP("pull_push_level")}},
    {"pull_push_down", LAO_PASS_FULLSCREEN, "vessel_push", 0, LAO_STAGE_DRAW, LAO_SCOPE_FRAME, LAO_REPEAT_LEVELS_DOWN, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {SDV__OF_HOST},
     {LAO_WRITE("pull_push_filled")},
     {LAO_READ("pull_push_level"), LAO_READ_COARSER("pull_push_filled")}},
    {"pull_push_result", LAO_PASS_FULLSCREEN, "vessel_push", 2, LAO_STAGE_DRAW, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {SDV__OF_HOST, {"@pull_push_result", '>', 0}},
     {LAO_WRITE("pull_push_result")},
     {LAO_READ("pull_push_filled"), LAO_READ("pull_push_filled")}}
};
static const lao_setting_row sdv__pull_push_settings[] = {
    SDV_PULL_PUSH_SETTINGS(LAO_SETTING_ROW)
};
static const lao_module sdv__pull_push_module = {
    "pull_push",
    sdv__pull_push_passes, (uint32_t)(sizeof sdv__pull_push_passes / sizeof sdv__pull_push_passes[0]),
    sdv__pull_push_images, (uint32_t)(sizeof sdv__pull_push_images / sizeof sdv__pull_push_images[0]),
    sdv__pull_push_settings, (uint32_t)(sizeof sdv__pull_push_settings / sizeof sdv__pull_push_settings[0]),
    NULL, 0, NULL, 0, NULL, 0
};
// clang-format on

SDV_API const lao_module *sdv_pull_push_module(void) {
    return &sdv__pull_push_module;
}

SDV_API void sdv_camera_margin(const lao_camera *camera, uint32_t width, uint32_t height,
                               uint32_t margin, lao_camera *wider) {
    double x = (double)width / ((double)width + 2.0 * margin);
    double y = (double)height / ((double)height + 2.0 * margin);
    size_t column;
    *wider = *camera;
    for (column = 0; column < 16; column += 4) {
        wider->projection[column] = (float)(x * (double)camera->projection[column]);
        wider->projection[column + 1] = (float)(y * (double)camera->projection[column + 1]);
    }
}

SDV_API const lao_module *sdv_module(void) {
    return &sdv__module;
}
