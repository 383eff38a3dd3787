/* ================================================================================================
 * module: passes, images, buffers and settings, as tables; the object that the passes read. Uses
   host, measure and near. */
// clang-format off
#define VSF__SMALL(image) LAO_WRITE_LEVEL(image, VSF_SHADOW_LEVEL)
#define VSF__TILES(image) LAO_WRITE_LEVEL(image, VSF_FOCUS_LEVEL)
#define VSF__SURFACE {"#surface_points", '>', 0}
#define VSF__ANY {NULL, 0, 0}
#define VSF__MESH LAO_READ("#surface_points"), LAO_READ("#surface_normals"), LAO_READ("#surface_triangles")
#define VSF__FRONT VSF__MESH, LAO_READ("surface_measure"), LAO_READ("surface_nearness"), LAO_READ("zbuffer"), LAO_READ("#surface_map")
#define VSF__PLAIN(format, size) format, size, 0, 0, NULL, 0, LAO_ENCODING_PLAIN

static const lao_image_row vsf__images[] = {
    /* one texel per vertex: its measure (1/mm); its nearness, x of the look-up */
    {"surface_measure",  VSF__PLAIN(LAO_FORMAT_R32F, LAO_SIZE_ITEMS), {0, 0, 0, 0}, VSF__ANY, {NULL, NULL, NULL, NULL}},
    {"surface_nearness", VSF__PLAIN(LAO_FORMAT_R32F, LAO_SIZE_ITEMS), {0, 0, 0, 0}, VSF__ANY, {NULL, NULL, NULL, NULL}},
    /* front faces, premultiplied, composed so far: a layer writes one partner from the other, and only where it has pixels.
       What a pixel has composed only grows, so the greater of both partners is all of it */
    {"surface_over",     VSF__PLAIN(LAO_FORMAT_RGBA16F, LAO_SIZE_FULL), {0, 0, 0, 0}, VSF__ANY, {NULL, NULL, NULL, NULL}},
    {"surface_composed", VSF__PLAIN(LAO_FORMAT_RGBA16F, LAO_SIZE_FULL), {0, 0, 0, 0}, {"surface_geometry", '=', 1}, {NULL, NULL, NULL, NULL}},
    /* whether the layer before has any pixel: by tiles, and all in all */
    {"surface_tiles",    LAO_FORMAT_R32F, LAO_SIZE_FIXED, VSF_LEFT_TILES, VSF_LEFT_TILES, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {"layers", '>', 0}, {NULL, NULL, NULL, NULL}},
    {"surface_left",     LAO_FORMAT_R32F, LAO_SIZE_FIXED, 1, 1, NULL, 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {"layers", '>', 0}, {NULL, NULL, NULL, NULL}},
    {"surface_z",        VSF__PLAIN(LAO_FORMAT_D32F, LAO_SIZE_FULL),    {1, 0, 0, 0}, VSF__ANY, {NULL, NULL, NULL, NULL}},
    /* the nearest front faces of all sets, for the effects */
    {"surface_nearest",  VSF__PLAIN(LAO_FORMAT_D32F, LAO_SIZE_FULL),    {1, 0, 0, 0}, VSF__ANY, {NULL, NULL, NULL, NULL}},
    {"surface_position", VSF__PLAIN(LAO_FORMAT_RGBA32F, LAO_SIZE_FULL), {0, 0, 0, 0}, {"surface_geometry", '=', 1}, {"position.X", "position.Y", "position.Z", "mask.V"}},
    {"surface_normal",   VSF__PLAIN(LAO_FORMAT_RGBA32F, LAO_SIZE_FULL), {0, 0, 0, 0}, {"surface_geometry", '=', 1}, {"normal.X", "normal.Y", "normal.Z", "measure.V"}},
    {"surface_lut",      VSF__PLAIN(LAO_FORMAT_RGBA32F, LAO_SIZE_FULL), {0, 0, 0, 0}, {"surface_geometry", '=', 1}, {"lut.R", "lut.G", "lut.B", "near.V"}},
    /* depth shadow: depths of what is covered at a quarter of the view's size (sum, weight), blurred along x, then y */
    {"shadow_depth",     LAO_FORMAT_RGBA32F, LAO_SIZE_VIEW, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {"depth_shadow", '=', 1}, {NULL, NULL, NULL, NULL}},
    {"shadow_x",         LAO_FORMAT_RGBA32F, LAO_SIZE_VIEW, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {"depth_shadow", '=', 1}, {NULL, NULL, NULL, NULL}},
    {"shadow_blurred",   LAO_FORMAT_RGBA32F, LAO_SIZE_VIEW, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {"depth_shadow", '=', 1}, {NULL, NULL, NULL, NULL}},
    /* focus: what is out of focus in a pixel and its depth (mm), blurred along x, then along y; by tiles whether there is any
       colour, and whether there is any that the blur along x, and along both, brings there */
    {"focus_color",      VSF__PLAIN(LAO_FORMAT_RGBA32F, LAO_SIZE_VIEW), {0, 0, 0, 0}, {"focus", '=', 1}, {NULL, NULL, NULL, NULL}},
    {"focus_depth",      VSF__PLAIN(LAO_FORMAT_R32F, LAO_SIZE_VIEW),    {0, 0, 0, 0}, {"focus", '=', 1}, {NULL, NULL, NULL, NULL}},
    {"focus_tiles",      LAO_FORMAT_R32F, LAO_SIZE_VIEW, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {"focus", '=', 1}, {NULL, NULL, NULL, NULL}},
    {"focus_near_tiles", LAO_FORMAT_RGBA32F, LAO_SIZE_VIEW, 0, 0, "*", 0, LAO_ENCODING_PLAIN, {0, 0, 0, 0}, {"focus", '=', 1}, {NULL, NULL, NULL, NULL}},
    {"focus_x",          VSF__PLAIN(LAO_FORMAT_RGBA32F, LAO_SIZE_VIEW), {0, 0, 0, 0}, {"focus", '=', 1}, {NULL, NULL, NULL, NULL}},
    {"focus_blurred",    VSF__PLAIN(LAO_FORMAT_RGBA32F, LAO_SIZE_VIEW), {0, 0, 0, 0}, {"focus", '=', 1}, {NULL, NULL, NULL, NULL}}
};

static const lao_pass_row vsf__passes[] = {
    /* back faces, opaque, among the scene: lines and they hide each other by depth */
    {"surface_back", LAO_PASS_DRAW_MESH, "surface_mesh", 0, LAO_STAGE_SHADE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_FRONT, {VSF__SURFACE},
     {LAO_WRITE_KEPT("shaded"), LAO_WRITE_KEPT("zbuffer")}, {VSF__MESH}},
    {"surface_measure", LAO_PASS_FULLSCREEN, "surface_measure", 0, LAO_STAGE_COMPOSE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE},
     {LAO_WRITE("surface_measure"), LAO_WRITE("surface_nearness")}, {LAO_READ("#surface_points"), LAO_READ("#surface_normals"), LAO_READ("#surface_rings"), LAO_READ("#surface_near"), LAO_READ("#surface_values")}},
    /* the nearest front face, then peel by peel those behind it, and all of them over the scene */
    {"surface_front", LAO_PASS_DRAW_MESH, "surface_mesh", 1, LAO_STAGE_COMPOSE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_BACK, {VSF__SURFACE},
     {LAO_WRITE_CLEARED("surface_over"), LAO_WRITE_OTHER_CLEARED("surface_over"), LAO_WRITE_CLEARED("surface_position"), LAO_WRITE_CLEARED("surface_normal"), LAO_WRITE_CLEARED("surface_lut"), LAO_WRITE_CLEARED("surface_z")}, {VSF__FRONT}},
    {"surface_nearest", LAO_PASS_FULLSCREEN, "surface_nearest", 0, LAO_STAGE_COMPOSE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_NONE, {VSF__SURFACE},
     {LAO_WRITE_KEPT("surface_nearest")}, {LAO_READ("surface_z")}},
    {"surface_tiles", LAO_PASS_FULLSCREEN, "surface_left", 0, LAO_STAGE_COMPOSE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"layers", '>', 0}},
     {LAO_WRITE("surface_tiles")}, {LAO_READ("surface_z")}},
    {"surface_left", LAO_PASS_FULLSCREEN, "surface_left", 1, LAO_STAGE_COMPOSE, LAO_SCOPE_PER_SET, LAO_REPEAT_COUNT, "layers", LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE},
     {LAO_WRITE("surface_left")}, {LAO_READ("surface_tiles")}},
    {"surface_peel", LAO_PASS_DRAW_MESH, "surface_mesh", 2, LAO_STAGE_COMPOSE, LAO_SCOPE_PER_SET, LAO_REPEAT_WITH_LAST, NULL, LAO_BLEND_NONE, LAO_DEPTH_NEARER, LAO_CULL_BACK, {VSF__SURFACE},
     {{"surface_over", LAO_LEVEL_SAME, 0, LAO_PHASE_OTHER, LAO_LOAD_KEEP}, LAO_WRITE_OTHER_CLEARED("surface_z")}, {VSF__FRONT, LAO_READ("surface_z"), LAO_READ("surface_left"), LAO_READ("surface_over")}},
    {"surface_tiles_left", LAO_PASS_FULLSCREEN, "surface_left", 2, LAO_STAGE_COMPOSE, LAO_SCOPE_PER_SET, LAO_REPEAT_WITH_LAST, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE},
     {LAO_WRITE_OTHER("surface_tiles")}, {LAO_READ("surface_z"), LAO_READ("surface_tiles")}},
    {"surface_over", LAO_PASS_FULLSCREEN, "surface_layers", 0, LAO_STAGE_COMPOSE, LAO_SCOPE_PER_SET, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE},
     {LAO_WRITE_OTHER("shaded"), LAO_WRITE("surface_composed")}, {LAO_READ("surface_over"), LAO_READ_OTHER("surface_over"), LAO_READ("shaded")}},
    /* effects of the whole picture */
    {"shadow_depth", LAO_PASS_FULLSCREEN, "surface_shadow", 0, LAO_STAGE_COMPOSE, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"depth_shadow", '=', 1}},
     {VSF__SMALL("shadow_depth")}, {LAO_READ("zbuffer"), LAO_READ("surface_nearest")}},
    {"shadow_x", LAO_PASS_FULLSCREEN, "surface_shadow", 1, LAO_STAGE_COMPOSE, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"depth_shadow", '=', 1}},
     {VSF__SMALL("shadow_x")}, {VSF__SMALL("shadow_depth")}},
    {"shadow_y", LAO_PASS_FULLSCREEN, "surface_shadow", 2, LAO_STAGE_COMPOSE, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"depth_shadow", '=', 1}},
     {VSF__SMALL("shadow_blurred")}, {VSF__SMALL("shadow_x")}},
    {"depth_shadow", LAO_PASS_FULLSCREEN, "surface_effect", 0, LAO_STAGE_COMPOSE, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"depth_shadow", '=', 1}},
     {LAO_WRITE_OTHER("shaded")}, {LAO_READ("shaded"), LAO_READ("zbuffer"), LAO_READ("surface_nearest"), VSF__SMALL("shadow_blurred")}},
    {"attenuation", LAO_PASS_FULLSCREEN, "surface_effect", 1, LAO_STAGE_COMPOSE, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"attenuation", '=', 1}},
     {LAO_WRITE_OTHER("shaded")}, {LAO_READ("shaded"), LAO_READ("zbuffer"), LAO_READ("surface_nearest")}},
    {"focus_pixels", LAO_PASS_FULLSCREEN, "surface_focus", 0, LAO_STAGE_COMPOSE, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"focus", '=', 1}},
     {LAO_WRITE("focus_color"), LAO_WRITE("focus_depth")}, {LAO_READ("shaded"), LAO_READ("zbuffer"), LAO_READ("surface_nearest")}},
    {"focus_tiles", LAO_PASS_FULLSCREEN, "surface_tiles", 0, LAO_STAGE_COMPOSE, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"focus", '=', 1}},
     {VSF__TILES("focus_tiles")}, {LAO_READ("focus_color")}},
    {"focus_near_tiles", LAO_PASS_FULLSCREEN, "surface_tiles", 1, LAO_STAGE_COMPOSE, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"focus", '=', 1}},
     {VSF__TILES("focus_near_tiles")}, {VSF__TILES("focus_tiles")}},
    {"focus_x", LAO_PASS_FULLSCREEN, "surface_blur", 0, LAO_STAGE_COMPOSE, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"focus", '=', 1}},
     {LAO_WRITE("focus_x")}, {LAO_READ("focus_color"), LAO_READ("focus_depth"), VSF__TILES("focus_near_tiles")}},
    {"focus_y", LAO_PASS_FULLSCREEN, "surface_blur", 1, LAO_STAGE_COMPOSE, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"focus", '=', 1}},
     {LAO_WRITE("focus_blurred")}, {LAO_READ("focus_x"), LAO_READ("focus_depth"), VSF__TILES("focus_near_tiles")}},
    {"focus", LAO_PASS_FULLSCREEN, "surface_effect", 2, LAO_STAGE_COMPOSE, LAO_SCOPE_FRAME, LAO_REPEAT_NONE, NULL, LAO_BLEND_NONE, LAO_DEPTH_NONE, LAO_CULL_NONE, {VSF__SURFACE, {"focus", '=', 1}},
     {LAO_WRITE_OTHER("shaded")}, {LAO_READ("shaded"), LAO_READ("zbuffer"), LAO_READ("surface_nearest"), LAO_READ("focus_blurred")}}
};

static const lao_setting_row vsf__settings[] = {
    VSF_SETTINGS(LAO_SETTING_ROW)
};

static const lao_module vsf__module = {
    "surface",
    vsf__passes, (uint32_t)(sizeof vsf__passes / sizeof vsf__passes[0]),
    vsf__images, (uint32_t)(sizeof vsf__images / sizeof vsf__images[0]),
    vsf__settings, (uint32_t)(sizeof vsf__settings / sizeof vsf__settings[0]),
    NULL, 0, NULL, 0,
    vsf__buffer_rows, (uint32_t)(sizeof vsf__buffer_rows / sizeof vsf__buffer_rows[0])
};
// clang-format on

VSF_API const lao_module *vsf_module(void) {
    return &vsf__module;
}

static void vsf__object_extra(vsf_object *object, uint32_t index, const float *data,
                              uint32_t count) {
    object->list[index].name = vsf__buffer_rows[index].name;
    object->list[index].data = data;
    object->list[index].texel_count = count;
}

VSF_API lao_result vsf_object_make(const vsf_host *host, const vsf_mesh *mesh, uint32_t max_texels,
                                   vsf_object *object) {
    lao_allocator a = vsf__allocator(host);
    vsf_buffers buffers;
    lao_result result;
    float *extra;
    uint32_t n, i, k;
    if (!mesh || !object) {
        return vsf__fail(host, VSF_LOG_NULL_ARGUMENT, "vsf_object_make");
    }
    result = vsf_buffers_make(host, mesh, max_texels, &buffers);
    if (result != LAO_OK) {
        return result;
    }
    n = buffers.vertex_count;
    if (max_texels && 2 * n > max_texels) {
        vsf_buffers_free(&buffers);
        return vsf__fail(host, VSF_LOG_MESH_DEVICE,
                         "distances of %u vertices need %u texels, the device has %u", n, 2 * n,
                         max_texels);
    }
    extra = (float *)lao__take(&a, 3 * (uint64_t)n + (uint64_t)4 * VSF_MAP_COLORS, sizeof *extra);
    if (!extra) {
        vsf_buffers_free(&buffers);
        return vsf__fail(host, VSF_LOG_MEMORY, "distances of %u vertices", n);
    }
    memset(object, 0, sizeof *object);
    object->allocator = a;
    object->buffers = buffers;
    object->near_pair = extra;
    object->values = extra + 2 * (size_t)n;
    object->map = extra + 3 * (size_t)n;
    object->step = VSF_NONE;
    for (i = 0; i < n; i++) {
        object->near_pair[2 * (size_t)i] = object->near_pair[2 * (size_t)i + 1] = VSF_FAR;
        object->values[i] = 0.0f;
    }
    for (i = 0; i < VSF_MAP_COLORS; i++) {
        for (k = 0; k < 4; k++) {
            object->map[4 * i + k] = k < 3 ? (float)i / (VSF_MAP_COLORS - 1) : 1.0f;
        }
    }
    vsf_buffers_describe(&object->buffers, object->list, &object->desc);
    vsf__object_extra(object, 4, object->values, n);
    vsf__object_extra(object, 5, object->near_pair, 2 * n);
    vsf__object_extra(object, 6, object->map, VSF_MAP_COLORS);
    object->desc.buffer_count = 7;
    return LAO_OK;
}

VSF_API void vsf_object_free(vsf_object *object) {
    if (object && object->near_pair) {
        lao__give(&object->allocator, object->near_pair);
        vsf_buffers_free(&object->buffers);
        memset(object, 0, sizeof *object);
    }
}

VSF_API uint32_t vsf_mesh_layers(const vsf_mesh *mesh) {
    const vsf_mesh_info *info = &mesh->info;
    uint32_t most = (uint32_t)vsf__settings[VSF_SETTING_ID_layers].standard;
    if (info->open_edges || info->crowded_edges || info->twisted_edges || info->parts > most) {
        return most;
    }
    return info->parts > 0 ? info->parts - 1 : 0;
}

VSF_API int vsf_object_time(vsf_object *object, const vsf_near *table, double time,
                            vsf_settings *settings, lao_object_desc *update) {
    uint32_t step = vsf_near_find(table, time, &settings->near_part);
    settings->near_gamma = table->gamma;
    settings->set |= VSF_SET(near_part) | VSF_SET(near_gamma);
    *update = object->desc;
    update->buffers = &object->list[5];
    update->buffer_count = 1;
    if (step == object->step || table->vertex_count != object->buffers.vertex_count) {
        return 0;
    }
    vsf_near_pair(table, step, object->near_pair);
    object->step = step;
    return 1;
}

#ifdef __cplusplus
}
#endif

#endif /* VESSELSURFACE_IMPLEMENTATION_DONE */
#endif /* VESSELSURFACE_IMPLEMENTATION */
