/* Lines as view-aligned quads into the G-buffer (METHODS 1.1, 2.8): four vertices a segment, pulled from the points.
   The text of three shaders: LAO_LINES_RIM gives the fragments the line's outline, LAO_LINES_DEPTH lets them write depth;
   halo none needs neither, and writing depth costs the early depth test. */
LAO_TEX(0, samplerBuffer, points)
LAO_TEX(1, samplerBuffer, colors)
LAO_TEX(2, samplerBuffer, order) /* of segments in time, where the lines have times */
LAO_TEX(3, sampler2D, far) /* variant 1: farthest depth of 4 x 4 tiles of 4 x 4 pixels, from each on */
LAO_CONSTANT(0, lao_constant_trail)
LAO_CONSTANT(1, lao_constant_halo)
LAO_CONSTANT(2, lao_constant_halo_function)
LAO_CONSTANT(3, lao_constant_halo_border)
LAO_CONSTANT(4, lao_constant_has_order)
LAO_CONSTANT(5, lao_constant_variant) /* 1: what lies behind `far` is left out */

LAO_VARYING(0, vec4, tangent_zoom)
LAO_VARYING(1, vec4, color_depth) /* red, green, blue; view depth (mm) */
#ifdef LAO_LINES_RIM
LAO_VARYING(2, vec4, rim) /* lao_rim_corner; opacity */
#ifndef LAO_LINES_DEPTH
LAO_VARYING(3, vec4, neighbours) /* lao_rim_neighbour at the end and at the start; with displaced borders depth decides */
#endif
#endif

#ifdef LAO_VERTEX
const bool trailing = lao_constant_trail == LAO_TRAIL_TAPER || lao_constant_trail == LAO_TRAIL_OPACITY;

lao_v3 view_direction(lao_v3 p) { return lao_frame.depth.w > 0.5 ? lao_v3_make(0.0, 0.0, -1.0) : p; }

struct segment_part {
    int first; /* texel of the segment's start */
    lao_v3 p1, p2, own;
    float t1, t2, now; /* ms */
    lao_trail_part part;
};

/* One end of what is drawn of a segment. */
struct segment_end {
    lao_v3 p, other, color; /* other: the neighbour's vector, 0 where there is none */
    float half_width, opacity;
};

segment_end end_of(segment_part s, bool at_end) {
    segment_end r;
    lao_v3 beyond = lao_transform(lao_frame.view, texelFetch(points, at_end ? s.first + 2 : s.first - 1).xyz);
    float distance = lao_trail_distance(at_end ? s.t2 : s.t1, s.now, lao_setting_period);
    r.p = at_end ? s.p2 : s.p1;
    r.other = at_end ? lao_v3_sub(beyond, s.p2) : lao_v3_sub(s.p1, beyond);
    r.color = texelFetch(colors, at_end ? s.first + 1 : s.first).xyz;
    r.half_width = 0.5 * lao_setting_width;
    r.opacity = 1.0;
    if (trailing) {
        float at = at_end ? s.part.last : s.part.first;
        float q = lao_min(distance / lao_setting_trail_length, 1.0);
        if (at > 0.0 && at < 1.0) { /* the trail ends inside the segment: there, not with it */
            lao_v3 c1 = texelFetch(colors, s.first).xyz;
            r.color = lao_v3_along(c1, lao_v3_sub(texelFetch(colors, s.first + 1).xyz, c1), at);
            r.p = lao_v3_along(s.p1, s.own, at);
            r.other = lao_v3_make(0.0, 0.0, 0.0);
            q = 1.0;
        }
        if (lao_constant_trail == LAO_TRAIL_TAPER) {
            r.half_width = r.half_width * lao_trail_width(q, lao_setting_taper_start, lao_setting_taper_width);
        } else {
            r.opacity = lao_trail_opacity(q, lao_setting_taper_start);
        }
    }
    if (lao_constant_trail == LAO_TRAIL_HIGHLIGHT) {
        r.color = lao_v3_scale(lao_desaturate(r.color), lao_trail_highlight(distance, lao_setting_highlight_beta));
    }
    return r;
}

lao_line_end join_of(segment_part s, segment_end end, bool at_end) {
    return lao_line_join(view_direction(end.p), s.own, end.other, end.half_width, at_end ? 1.0 : -1.0);
}

/* A corner as the neighbour at that end sees it. */
lao_v2 neighbour_of(segment_part s, segment_end end, bool at_end, lao_v3 corner) {
    lao_line_end join = join_of(s, end, at_end);
    return lao_rim_neighbour(lao_v3_sub(corner, end.p), view_direction(end.p), end.other, end.half_width,
                             at_end ? 1.0 : -1.0, join.square);
}

/* Does all of the segment lie behind what was drawn before? All of it is within 3/4 of the width from the line between its ends
   (a corner is at most sqrt(2) half widths from its end); a halo lies farther back than its line. The line is cut where the box
   around a piece may outgrow 4 x 4 tiles less one. Depth is linear along it on the screen; in front of it, nearer than that. The
   same for all four corners. */
bool hidden(lao_v3 p1, lao_v3 p2) {
    float r = 0.75 * lao_setting_width;
    float nearest = max(p1.z, p2.z);
    vec2 slope = max(abs(p1.xy / p1.z), abs(p2.xy / p2.z)) * nearest;
    vec2 size = lao_ball_size(lao_v3_make(slope.x, slope.y, nearest), r, lao_frame.scale, lao_frame.depth.w) + 1.0;
    vec4 c1 = lao_project(lao_frame.projection, p1);
    vec4 c2 = lao_project(lao_frame.projection, p2);
    vec4 front1 = lao_project(lao_frame.projection, lao_v3_make(0.0, 0.0, p1.z + r));
    vec4 front2 = lao_project(lao_frame.projection, lao_v3_make(0.0, 0.0, p2.z + r));
    vec2 at = (c1.xy / c1.w * 0.5 + 0.5) * lao_frame.viewport.xy;
    vec2 way = (c2.xy / c2.w * 0.5 + 0.5) * lao_frame.viewport.xy - at;
    float depth = front1.z / front1.w;
    float deeper = front2.z / front2.w - depth;
    vec2 pieces = ceil(abs(way) / (12.0 - 2.0 * size));
    float count = max(max(pieces.x, pieces.y), 1.0);
    bool behind = min(size.x, size.y) >= 1.0 && max(size.x, size.y) < 6.0 && count <= 8.0;
    for (float i = 0.0; behind && i < count; i += 1.0) {
        float t1 = i / count;
        float t2 = (i + 1.0) / count;
        vec2 low = min(at + t1 * way, at + t2 * way) - size;
        ivec2 tile = ivec2(floor(clamp(low, vec2(0.0), lao_frame.viewport.xy - 1.0) * 0.25));
        float around = texelFetch(far, tile, 0).x;
        behind = lao_behind(depth + t1 * deeper, around, lao_frame.scale.z) && lao_behind(depth + t2 * deeper, around, lao_frame.scale.z);
    }
    return behind;
}

void main() {
    segment_part s;
    int segment = int(LAO_VERTEX_INDEX >> 2u);
    if (trailing && lao_constant_has_order == 1) {
        segment = int(texelFetch(order, segment).x);
    }
    s.first = segment + 1;
    bool at_end = (LAO_VERTEX_INDEX & 2u) != 0u;
    float side = (LAO_VERTEX_INDEX & 1u) != 0u ? 1.0 : -1.0;
    vec4 start = texelFetch(points, s.first);
    vec4 end = texelFetch(points, s.first + 1);
    bool seen = start.w < LAO_GHOST_TIME && end.w < LAO_GHOST_TIME; /* not between two lines */
    s.t1 = start.w;
    s.t2 = end.w;
    s.now = lao_trail_now(lao_frame.scale.w, lao_setting_period);
    if (trailing) {
        s.part = lao_trail_clip(s.t1, s.t2, s.now, lao_setting_trail_length, lao_setting_period);
        seen = seen && s.part.first < s.part.last;
    }
    tangent_zoom = vec4(0.0);
    color_depth = vec4(0.0);
#ifdef LAO_LINES_RIM
    rim = vec4(0.0);
#ifndef LAO_LINES_DEPTH
    neighbours = vec4(0.0);
#endif
#endif
    s.p1 = lao_transform(lao_frame.view, start.xyz);
    s.p2 = lao_transform(lao_frame.view, end.xyz);
    if (lao_constant_variant == 1) {
        seen = seen && !hidden(s.p1, s.p2);
    }
    if (!seen) {
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0); /* outside, so that the quad is culled here */
        return;
    }
    s.own = lao_v3_sub(s.p2, s.p1);
    segment_end at = end_of(s, at_end);
    lao_line_end join = join_of(s, at, at_end);
    lao_v3 corner = lao_v3_add(lao_v3_along(at.p, join.across, side), join.along);
    tangent_zoom = vec4(join.tangent, lao_zoom(lao_frame.projection, lao_frame.viewport, at.p, join.normal));
    color_depth = vec4(at.color, -corner.z);
#ifdef LAO_LINES_RIM
    LAO_EXACT float seen_length = join.seen / at.half_width;
    rim = vec4(lao_rim_corner(side, at_end, join.square, seen_length), at.opacity);
#ifndef LAO_LINES_DEPTH
    if (lao_constant_halo != LAO_HALO_NONE) {
        neighbours = vec4(neighbour_of(s, end_of(s, true), true, corner), neighbour_of(s, end_of(s, false), false, corner));
    }
#endif
#endif
    lao_emit(lao_project(lao_frame.projection, corner));
}
#endif

LAO_OUT(0, vec4, out_color)
LAO_OUT(1, vec4, out_tangent)
LAO_OUT(2, vec4, out_depth)

#ifdef LAO_FRAGMENT
void main() {
    lao_v3 color = color_depth.xyz;
    float alpha = 1.0;
#ifdef LAO_LINES_RIM
    if (lao_constant_trail == LAO_TRAIL_OPACITY) {
        ivec2 pixel = LAO_PIXEL;
        if (rim.w < lao_screen_door(uint(pixel.x), uint(pixel.y))) {
            discard;
        }
    }
    if (lao_constant_halo != LAO_HALO_NONE) {
        float s = lao_rim(rim.xyz);
#ifndef LAO_LINES_DEPTH
        s = lao_rim_union(lao_rim_union(s, neighbours.xy), neighbours.zw);
#endif
        float begin = lao_halo_begin(lao_setting_halo_width, lao_constant_halo);
        float light = lao_halo_light(s, begin, lao_constant_halo_border);
        color = lao_v3_scale(color, light);
        alpha = lao_light_pack(light);
#ifdef LAO_LINES_DEPTH
        float back = lao_halo_displacement(s, begin, lao_constant_halo_function);
        LAO_EXACT float z = color_depth.w + back * lao_setting_halo_depth * lao_frame.depth.z;
        gl_FragDepth = s < begin ? gl_FragCoord.z : lao_halo_depth(lao_frame.unproject, z);
#endif
    }
#endif
    out_color = vec4(color, alpha);
    out_tangent = vec4(lao_v3_unit(tangent_zoom.xyz, lao_v3_make(1.0, 0.0, 0.0)), tangent_zoom.w);
    out_depth = vec4(lao_scene_depth(lao_frame.depth, color_depth.w));
}
#endif
