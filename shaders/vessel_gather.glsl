/* One coarser level of places and normals: of vessels wherever there are any. */
LAO_TEX(0, sampler2D, place)
LAO_TEX(1, sampler2D, facing)

LAO_OUT(0, vec4, out_place)  /* mean place; share of covered pixels */
LAO_OUT(1, vec4, out_facing) /* mean normal, unit */

#ifdef LAO_FRAGMENT
void main() {
    ivec2 size = ivec2(lao_step.source.xy);
    sdv_mix places = sdv_mix_start(vec4(0.0));
    sdv_mix normals = places;
    lao_v3 first = texelFetch(facing, LAO_PIXEL * 2, 0).xyz;
    LAO_EXACT float covered = 0.0;
    LAO_EXACT float count = 0.0;
    for (int i = 0; i < 4; i++) {
        ivec2 child = LAO_PIXEL * 2 + ivec2(i & 1, i >> 1);
        if (child.x < size.x && child.y < size.y) {
            vec4 p = texelFetch(place, child, 0);
            float h = lao_max(p.w, SDV_BACKGROUND_PRESENCE);
            places = sdv_mix_add(places, vec4(p.xyz, 0.0), h, 0.25);
            normals = sdv_mix_add(normals, vec4(texelFetch(facing, child, 0).xyz, 0.0), h, 0.25);
            covered = covered + p.w;
            count = count + 1.0;
        }
    }
    LAO_EXACT float share = covered / count;
    out_place = vec4(sdv_mix_value(places).xyz, share);
    out_facing = vec4(lao_v3_unit(sdv_mix_value(normals).xyz, first), 0.0);
}
#endif
