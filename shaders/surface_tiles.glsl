/* Where the focus blur has anything to do. Variant 0: is there any colour in a tile of pixels? 1: as far as the widest blur
   reaches, is there any along x (x), and along x and y (y)? */
LAO_TEX(0, sampler2D, source)
LAO_CONSTANT(0, lao_constant_variant)
LAO_OUT(0, vec4, out_found)
#ifdef LAO_FRAGMENT
float any_color(ivec2 tile) {
    ivec2 first = tile * VSF_FOCUS_PIXELS;
    ivec2 end = min(first + ivec2(VSF_FOCUS_PIXELS), textureSize(source, 0));
    float found = 0.0;
    for (int y = first.y; y < end.y && found <= 0.0; y++) {
        for (int x = first.x; x < end.x && found <= 0.0; x++) {
            vec4 color = texelFetch(source, ivec2(x, y), 0);
            found = lao_max(lao_max(color.x, color.y), lao_max(color.z, color.w));
        }
    }
    return found > 0.0 ? 1.0 : 0.0;
}

vec2 within_reach(ivec2 tile) {
    int pixels = vsf_reach(lao_setting_focus_blur, VSF_BLUR_MOST);
    int reach = (pixels + VSF_FOCUS_PIXELS - 1) / VSF_FOCUS_PIXELS;
    ivec2 size = textureSize(source, 0);
    ivec2 first = max(tile - ivec2(reach), ivec2(0));
    ivec2 last = min(tile + ivec2(reach), size - ivec2(1));
    vec2 found = vec2(0.0);
    for (int y = first.y; y <= last.y; y++) {
        for (int x = first.x; x <= last.x; x++) {
            float here = texelFetch(source, ivec2(x, y), 0).x;
            found.y = lao_max(found.y, here);
            found.x = lao_max(found.x, y == tile.y ? here : 0.0);
        }
    }
    return found;
}

void main() {
    if (lao_constant_variant == 0) {
        out_found = vec4(any_color(LAO_PIXEL));
    } else {
        out_found = vec4(within_reach(LAO_PIXEL), 0.0, 0.0);
    }
}
#endif
