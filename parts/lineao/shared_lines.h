/* ================================================================================================
 * shared_lines: texels of the G-buffer and their pyramid, the camera, and what a line is on the
   screen: its ribbon, its halo, its trail. Uses shared_math. */
/* LAO_SHARED_BEGIN */
/* ---- texels */
/* Cosine and sine of the double angle to the paper's alpha = |t.x| (Eq. 10) and its validity. */
LAO_FN lao_v2 lao_axial_alpha(lao_v2 axial) {
    LAO_EXACT float length2 = lao_v2_dot(axial, axial);
    if (!(length2 > 0.25f)) {
        return lao_v2_make(0.0f, 0.0f);
    }
    LAO_EXACT float alpha = lao_sqrt(lao_max(0.5f + 0.5f * axial.x, 0.0f));
    return lao_v2_make(alpha, 1.0f);
}
/* A mean of axial vectors as a direction; (0, 0) where they cancel. */
LAO_FN lao_v2 lao_axial_unit(lao_v2 mean) {
    LAO_EXACT float length2 = lao_v2_dot(mean, mean);
    if (!(length2 > 1.0e-4f)) {
        return lao_v2_make(0.0f, 0.0f);
    }
    LAO_EXACT float c = mean.x / lao_sqrt(length2);
    LAO_EXACT float s = mean.y / lao_sqrt(length2);
    return lao_v2_make(c, s);
}
/* Mean of alpha times validity, and of validity, as alpha and validity. */
LAO_FN lao_v2 lao_alpha_mean(lao_v2 mean) {
    if (!(mean.y > 0.0f)) {
        return lao_v2_make(0.0f, 0.0f);
    }
    LAO_EXACT float alpha = mean.x / mean.y;
    return lao_v2_make(alpha, mean.y);
}
/* Components in [-1, 1] to [0, 1] and back. */
LAO_FN lao_v3 lao_signed_pack(lao_v3 v) {
    LAO_EXACT float x = v.x * 0.5f + 0.5f;
    LAO_EXACT float y = v.y * 0.5f + 0.5f;
    LAO_EXACT float z = v.z * 0.5f + 0.5f;
    return lao_v3_make(x, y, z);
}
LAO_FN lao_v3 lao_signed_unpack(lao_v4 texel) {
    LAO_EXACT float x = texel.x * 2.0f - 1.0f;
    LAO_EXACT float y = texel.y * 2.0f - 1.0f;
    LAO_EXACT float z = texel.z * 2.0f - 1.0f;
    return lao_v3_make(x, y, z);
}

#define LAO_ALIGN_ROTATION 0
#define LAO_ALIGN_PAPER 1
#define LAO_ALIGN_NONE 2
/* What a sample of the occlusion reads of a level is one word: nearness in bits 0 - 19 (depth 1 is
   1, depth 0 is LAO_LEVEL_NEAREST; 0: nothing is covered), in bit 20 whether a direction is known,
   the direction in bits 21 - 31: 1/2048 of a half turn, so that differences of words wrap as
   directions do; in the paper's alignment 1/2047 of alpha. */
#define LAO_LEVEL_NEAREST 1048575u
#define LAO_LEVEL_KNOWN 1048576u
#define LAO_LEVEL_TURN 4292870144u /* the bits of the direction */
#define LAO_LEVEL_STEPS 1048574.0f /* between depth 0 and 1 */
/* A covered texel; direction: cosine and sine of the double angle, or alpha and its validity. */
LAO_FN lao_uint lao_level_pack(float depth, lao_v2 direction, lao_int align) {
    LAO_EXACT float q = lao_floor(lao_clamp01(depth) * LAO_LEVEL_STEPS + 0.5f);
    lao_uint word = LAO_LEVEL_NEAREST - LAO_U(q > 0.0f ? lao_min(q, LAO_LEVEL_STEPS) : 0.0f);
    if (align == LAO_ALIGN_ROTATION && lao_v2_dot(direction, direction) > 0.25f) {
        LAO_EXACT float turn = lao_floor(lao_atan2(direction.y, direction.x) * 325.949323f + 0.5f);
        word = word | LAO_LEVEL_KNOWN | (LAO_U(LAO_I(turn)) << 21u);
    }
    if (align == LAO_ALIGN_PAPER && direction.y > 0.5f) {
        LAO_EXACT float alpha = lao_floor(lao_clamp01(direction.x) * 2047.0f + 0.5f);
        word = word | LAO_LEVEL_KNOWN | (LAO_U(alpha) << 21u);
    }
    return word;
}
LAO_FN bool lao_level_known(lao_uint word) {
    return (word & LAO_LEVEL_KNOWN) != 0u;
}
/* In [0, 1]; 1 where nothing is covered. */
LAO_FN float lao_level_depth(lao_uint word) {
    LAO_EXACT float d =
        LAO_F(LAO_I(LAO_LEVEL_NEAREST - (word & LAO_LEVEL_NEAREST))) / LAO_LEVEL_STEPS;
    return lao_min(d, 1.0f);
}
/* The two numbers of lao_level_pack; (0, 0) where no direction is known. */
LAO_FN lao_v2 lao_level_direction(lao_uint word, lao_int align) {
    if (!lao_level_known(word)) {
        return lao_v2_make(0.0f, 0.0f);
    }
    LAO_EXACT float code = LAO_F(LAO_I(word >> 21u));
    if (align == LAO_ALIGN_PAPER) {
        return lao_v2_make(code / 2047.0f, 1.0f);
    }
    LAO_EXACT float turn = code * 0.00048828125f;
    return lao_v2_make(lao_cos_turns(turn), lao_sin_turns(turn));
}
/* How much nearer than `centre` a texel is, in steps of depth. */
LAO_FN float lao_level_nearer(lao_uint centre, lao_uint word) {
    return LAO_F(LAO_I(word & LAO_LEVEL_NEAREST) - LAO_I(centre & LAO_LEVEL_NEAREST));
}

/* ---- pyramid (METHODS 1.10) */
/* A texel of the sums: two numbers of the direction, covered texels of level 0 below it, depth. */
struct lao_level_sum {
    float x, y, depth, weight, covered;
    lao_v3 tangent;
};
#ifndef LAO_GLSL
typedef struct lao_level_sum lao_level_sum;
#endif
LAO_FN lao_level_sum lao_level_sum_start(lao_v3 zero) {
    lao_level_sum sum;
    sum.x = 0.0f;
    sum.y = 0.0f;
    sum.depth = 0.0f;
    sum.weight = 0.0f;
    sum.covered = 0.0f;
    sum.tangent = zero;
    return sum;
}
/* Stencil [1 3 3 1] / 8 at child -1 .. 2 of a texel. */
LAO_FN float lao_gauss_weight(lao_int child) {
    return child == 0 || child == 1 ? 0.375f : 0.125f;
}
/* Adds a child; its tangent is turned to the side of those before it. */
LAO_FN lao_level_sum lao_level_sum_add(lao_level_sum sum, lao_v4 child, lao_v3 tangent,
                                       float stencil) {
    lao_level_sum r = sum;
    LAO_EXACT float w = stencil * child.z;
    LAO_EXACT float x = sum.x + w * child.x;
    LAO_EXACT float y = sum.y + w * child.y;
    LAO_EXACT float d = sum.depth + w * child.w;
    LAO_EXACT float side = lao_v3_dot(sum.tangent, tangent) < 0.0f ? -w : w;
    r.x = x;
    r.y = y;
    r.depth = d;
    r.weight = sum.weight + w;
    r.covered = sum.covered + 4.0f * w;
    r.tangent = lao_v3_along(sum.tangent, tangent, side);
    return r;
}
/* Nothing covered: direction 0, depth 1 (far). */
LAO_FN lao_v4 lao_level_sum_mean(lao_level_sum sum) {
    if (!(sum.weight > 0.0f)) {
        return lao_v4_make(0.0f, 0.0f, 0.0f, 1.0f);
    }
    LAO_EXACT float x = sum.x / sum.weight;
    LAO_EXACT float y = sum.y / sum.weight;
    LAO_EXACT float d = sum.depth / sum.weight;
    return lao_v4_make(x, y, sum.covered, d);
}

/* A texel of level 0 as a child of level 1. */
LAO_FN lao_v4 lao_level_child(lao_uint word, lao_int align) {
    lao_v2 direction = lao_level_direction(word, align);
    LAO_EXACT float covered = (word & LAO_LEVEL_NEAREST) != 0u ? 1.0f : 0.0f;
    return lao_v4_make(direction.x, direction.y, covered, lao_level_depth(word));
}
/* What a sample reads of a mean. */
LAO_FN lao_uint lao_level_word(lao_v4 mean, lao_int align) {
    lao_v2 direction = lao_v2_make(mean.x, mean.y);
    if (!(mean.z > 0.0f)) {
        return 0u;
    }
    if (align == LAO_ALIGN_ROTATION) {
        direction = lao_axial_unit(direction);
    }
    if (align == LAO_ALIGN_PAPER) {
        direction = lao_alpha_mean(direction);
    }
    return lao_level_pack(mean.w, direction, align);
}

/* ---- camera */
/* View depth (mm along the view axis) to the depth that occlusion compares: 0..1 over the scene
 * sphere (METHODS 1.3). */
LAO_FN float lao_scene_depth(lao_v4 depth, float z) {
    LAO_EXACT float d = (z - depth.x) * depth.y;
    return lao_clamp01(d);
}
LAO_FN float lao_view_depth(lao_v4 depth, float scene_depth) {
    LAO_EXACT float z = depth.x + scene_depth * depth.z;
    return z;
}
/* Slope (perspective) or position (orthographic) of the view ray through a pixel centre; px = ix +
 * 0.5. */
LAO_FN lao_v2 lao_pixel_slope(lao_v4 ray, float px, float py) {
    LAO_EXACT float x = ray.x * px + ray.z;
    LAO_EXACT float y = ray.y * py + ray.w;
    return lao_v2_make(x, y);
}
/* The view ray through a pixel centre in the world, from the eye (orthographic: from the eye's
   plane): a point and a unit vector. Choices, no branch: lavapipe compiles a pass anew in every
   frame for a branch that depends on uniforms alone. */
LAO_FN lao_v3 lao_ray_origin(lao_m4 world, lao_v2 slope, float orthographic) {
    bool flat_view = orthographic > 0.5f;
    lao_v3 plane = lao_transform(world, lao_v3_make(slope.x, slope.y, 0.0f));
    return lao_v3_make(flat_view ? plane.x : world.w.x, flat_view ? plane.y : world.w.y,
                       flat_view ? plane.z : world.w.z);
}
LAO_FN lao_v3 lao_ray_direction(lao_m4 world, lao_v2 slope, float orthographic) {
    lao_v2 s = orthographic > 0.5f ? lao_v2_make(0.0f, 0.0f) : slope;
    LAO_EXACT float x = world.x.x * s.x + world.y.x * s.y - world.z.x;
    LAO_EXACT float y = world.x.y * s.x + world.y.y * s.y - world.z.y;
    LAO_EXACT float z = world.x.z * s.x + world.y.z * s.y - world.z.z;
    return lao_v3_unit(lao_v3_make(x, y, z), lao_v3_make(0.0f, 0.0f, -1.0f));
}
/* Unit vector from the surface at that pixel towards the eye: the direction of the head light. */
LAO_FN lao_v3 lao_towards_eye(lao_v2 slope, float orthographic) {
    lao_v3 axis = lao_v3_make(0.0f, 0.0f, 1.0f);
    bool flat_view = orthographic > 0.5f;
    return lao_v3_unit(lao_v3_make(flat_view ? 0.0f : -slope.x, flat_view ? 0.0f : -slope.y, 1.0f),
                       axis);
}
/* Pixels per mm at view position p across the direction o (METHODS 1.4): Eq. 14 in pixels,
 * aspect-correct, xy only. */
LAO_FN float lao_zoom(lao_m4 projection, lao_v4 viewport, lao_v3 p, lao_v3 o) {
    lao_v4 a = lao_project(projection, p);
    lao_v4 b = lao_project(projection, lao_v3_add(p, o));
    LAO_EXACT float aw = lao_max(lao_abs(a.w), 1.0e-6f);
    LAO_EXACT float bw = lao_max(lao_abs(b.w), 1.0e-6f);
    LAO_EXACT float x = 0.5f * viewport.x * (b.x / bw - a.x / aw);
    LAO_EXACT float y = 0.5f * viewport.y * (b.y / bw - a.y / aw);
    LAO_EXACT float r = lao_sqrt(x * x + y * y);
    return r;
}

/* Pixels per mm from depth alone, for a host's G-buffer without zoom: exact on the view axis. */
LAO_FN float lao_pixel_zoom(lao_v4 scale, lao_v4 depth, float scene_depth) {
    LAO_EXACT float z = lao_max(lao_view_depth(depth, scene_depth), 1.0e-6f);
    LAO_EXACT float r = lao_abs(scale.y) / (depth.w > 0.5f ? 1.0f : z);
    return r;
}

/* ---- lines (METHODS 1.2, 2.8) */
/* Where one end of a segment puts its two corners: p + along -/+ across. */
struct lao_line_end {
    lao_v3 across, along, tangent, normal;
    float square; /* 1: ends square, half a width beyond the joint; 0: at it, or mitred */
    float seen;   /* length of `own` across the view */
};
#ifndef LAO_GLSL
typedef struct lao_line_end lao_line_end;
#endif
/* e: direction of view at the end point; own, other: the segment's and its neighbour's vector in
   the line's direction (other = 0: no neighbour); outward: +1 at the segment's end, -1 at its
   start. Turns up to 90 degrees as seen share mitred corners; sharper ones, and mitres longer than
   half a segment, end square, half a width beyond the joint, so that the two ends cover the wedge
   between them. */
LAO_FN lao_line_end lao_line_join(lao_v3 e, lao_v3 own, lao_v3 other, float half_width,
                                  float outward) {
    lao_line_end end;
    lao_v3 ray = lao_v3_unit(e, lao_v3_make(0.0f, 0.0f, -1.0f));
    lao_v3 right = lao_v3_make(1.0f, 0.0f, 0.0f);
    lao_v3 own_cross = lao_v3_cross(ray, lao_v3_unit(own, right));
    lao_v3 other_cross = lao_v3_cross(ray, lao_v3_unit(other, lao_v3_make(0.0f, 0.0f, 0.0f)));
    lao_v3 o = lao_v3_unit(own_cross, right);
    LAO_EXACT float own_length2 = lao_v3_dot(own_cross, own_cross);
    LAO_EXACT float other_length2 = lao_v3_dot(other_cross, other_cross);
    if (own_length2 < 1.0e-12f) {
        o = right;
    }
    end.normal = o;
    end.across = lao_v3_scale(o, half_width);
    end.along = lao_v3_make(0.0f, 0.0f, 0.0f);
    end.tangent = lao_v3_unit(own, right);
    end.square = 0.0f;
    LAO_EXACT float seen = lao_sqrt(own_length2 * lao_v3_dot(own, own));
    end.seen = seen;
    if (other_length2 > 1.0e-12f) {
        lao_v3 n = lao_v3_unit(other_cross, o);
        LAO_EXACT float c = lao_v3_dot(o, n);
        LAO_EXACT float reach2 = half_width * half_width * (1.0f - c) / lao_max(1.0f + c, 1.0e-6f);
        LAO_EXACT float shorter =
            lao_min(own_length2 * lao_v3_dot(own, own), other_length2 * lao_v3_dot(other, other));
        if (own_length2 >= 1.0e-12f && (c >= 0.87f || (c >= 0.0f && 4.0f * reach2 <= shorter))) {
            LAO_EXACT float s = half_width / (1.0f + c);
            end.across = lao_v3_scale(lao_v3_add(o, n), s);
            end.tangent = lao_v3_unit(lao_v3_add(own, other), end.tangent);
        } else {
            end.along = lao_v3_scale(lao_v3_cross(o, ray), half_width * outward);
            end.square = 1.0f;
        }
    }
    return end;
}
/* n = (T x L) x T, the line normal that faces the light L (Zoeckler 1996); any normal where the
 * line is seen end-on. */
LAO_FN lao_v3 lao_line_normal(lao_v3 t, lao_v3 l) {
    LAO_EXACT float tl = lao_v3_dot(t, l);
    lao_v3 n = lao_v3_along(l, t, -tl);
    LAO_EXACT float length2 = lao_v3_dot(n, n);
    if (!(length2 > 1.0e-12f)) {
        lao_v3 up = lao_v3_make(0.0f, 1.0f, 0.0f);
        LAO_EXACT float tu = lao_v3_dot(t, up);
        return lao_v3_unit(lao_v3_along(up, t, -tu), lao_v3_make(1.0f, 0.0f, 0.0f));
    }
    LAO_EXACT float inverse = 1.0f / lao_sqrt(length2);
    return lao_v3_scale(n, inverse);
}
/* The line's direction on the screen as an axial vector (cos 2a, sin 2a), (0, 0) when it is seen
   end-on (METHODS 2.1, 2.3): the projection of the view-space tangent, exact at every pixel.
   `scale` is lao_frame_uniforms.scale. */
LAO_FN lao_v2 lao_screen_axial(lao_v3 t, lao_v2 slope, lao_v4 scale, float orthographic) {
    LAO_EXACT float k = orthographic > 0.5f ? 0.0f : t.z;
    LAO_EXACT float x = (t.x + slope.x * k) * scale.x;
    LAO_EXACT float y = (t.y + slope.y * k) * scale.y;
    LAO_EXACT float length2 = x * x + y * y;
    LAO_EXACT float least = 1.0e-8f * scale.y * scale.y;
    if (!(length2 > least)) {
        return lao_v2_make(0.0f, 0.0f);
    }
    LAO_EXACT float c = (x * x - y * y) / length2;
    LAO_EXACT float s = 2.0f * x * y / length2;
    return lao_v2_make(c, s);
}

/* ---- segments hidden behind others */
/* Half the size (px, each way) of what a ball of radius r (mm) around p covers, at most: seen in
   perspective x / w is bent by r / w for its own sake and by |x / w| r / w for that of w. scale:
   lao_frame_uniforms.scale. Not positive where the ball reaches behind the eye. */
LAO_FN lao_v2 lao_ball_size(lao_v3 p, float r, lao_v4 scale, float orthographic) {
    LAO_EXACT float w = orthographic > 0.5f ? 1.0f : -p.z - r;
    LAO_EXACT float sx = orthographic > 0.5f ? 1.0f : 1.0f + lao_abs(p.x / p.z);
    LAO_EXACT float sy = orthographic > 0.5f ? 1.0f : 1.0f + lao_abs(p.y / p.z);
    LAO_EXACT float x = lao_abs(scale.x) * r * sx / w;
    LAO_EXACT float y = lao_abs(scale.y) * r * sy / w;
    return lao_v2_make(x, y);
}
/* Is a fragment at least as deep as `near` behind all of `far`? By several times what
   interpolation takes from a depth of 1, where clip depth is [-w, w] too. */
LAO_FN bool lao_behind(float near, float far, float reversed) {
    LAO_EXACT float behind = reversed > 0.5f ? far - near : near - far;
    return behind > 2.0e-5f;
}

/* ---- halos (METHODS 3; Koehler 2017, 4.3; Everts 2009) */
#define LAO_HALO_NONE 0
#define LAO_HALO_UNIFORM 1
#define LAO_HALO_DEPTH 2
#define LAO_HALO_SQRT 0
#define LAO_HALO_LINEAR 1
#define LAO_HALO_SQUARE 2
#define LAO_HALO_HARD 0
#define LAO_HALO_SOFT 1
/* What a corner of a segment gives the fragments to tell how far out they are: x = -1 .. 1 across
   the line; y, z: how far beyond the end and the start of the segment, in half widths, so that a
   square end has a border as the sides have; a mitred or open one has none, as it ends at 0.
   length: of the segment as seen, in half widths. */
LAO_FN lao_v3 lao_rim_corner(float side, bool at_end, float square, float length) {
    LAO_EXACT float beyond = -length - square;
    return lao_v3_make(side, at_end ? square : beyond, at_end ? beyond : square);
}
/* A place x, seen from a joint where two segments end square, in half widths of the neighbour,
   which leaves in the line's direction (outward: 1) or comes from there (-1): across it, and how
   far beyond its end. Far outside where the ends are not square. */
LAO_FN lao_v2 lao_rim_neighbour(lao_v3 x, lao_v3 e, lao_v3 other, float half_width, float outward,
                                float square) {
    if (square < 0.5f) {
        return lao_v2_make(2.0f, 2.0f);
    }
    lao_v3 right = lao_v3_make(1.0f, 0.0f, 0.0f);
    lao_v3 ray = lao_v3_unit(e, lao_v3_make(0.0f, 0.0f, -1.0f));
    lao_v3 o = lao_v3_unit(lao_v3_cross(ray, lao_v3_unit(other, right)), right);
    LAO_EXACT float across = lao_v3_dot(x, o) / half_width;
    LAO_EXACT float along = -outward * lao_v3_dot(x, lao_v3_cross(o, ray)) / half_width;
    return lao_v2_make(across, along);
}
/* The outline of two ribbons that overlap at a joint is that of their union. */
LAO_FN float lao_rim_union(float s, lao_v2 neighbour) {
    return lao_min(s, lao_max(lao_abs(neighbour.x), neighbour.y));
}
/* 0 in the middle of a line, 1 at its outline. */
LAO_FN float lao_rim(lao_v3 rim) {
    float s = lao_abs(rim.x);
    s = rim.y > s ? rim.y : s;
    return rim.z > s ? rim.z : s;
}
/* Where the border begins. */
LAO_FN float lao_halo_begin(float width, lao_int halo) {
    LAO_EXACT float begin = 1.0f - (halo == LAO_HALO_DEPTH ? 2.0f * width : width);
    return begin;
}
/* The light that a fragment keeps: all of it inside, none in a hard border. */
LAO_FN float lao_halo_light(float s, float begin, lao_int border) {
    LAO_EXACT float t = (1.0f - s) / lao_max(1.0f - begin, 1.0e-6f);
    LAO_EXACT float soft = t * t;
    return s < begin ? 1.0f : (border == LAO_HALO_SOFT ? soft : 0.0f);
}
/* The alpha of the G-buffer's colour: covered (at least 1/2), and the light kept in 128 steps, by
   which highlights are dimmed as the colour is. */
LAO_FN float lao_light_pack(float light) {
    LAO_EXACT float alpha = 0.501960784f + 0.498039216f * light; /* (128 + 127 light) / 255 */
    return alpha;
}
LAO_FN float lao_light_unpack(float alpha) {
    LAO_EXACT float light = (255.0f * alpha - 128.0f) / 127.0f;
    return lao_clamp01(light);
}
/* How far back a fragment is moved, in parts of the largest displacement: 0 inside, f(s) in the
   border (f_displacement). */
LAO_FN float lao_halo_displacement(float s, float begin, lao_int function) {
    LAO_EXACT float square = s * s;
    float f = function == LAO_HALO_SQRT ? lao_sqrt(s) : (function == LAO_HALO_LINEAR ? s : square);
    return s < begin ? 0.0f : f;
}
/* Depth buffer value of view depth z: the inverse of lao_frame_uniforms.unproject. */
LAO_FN float lao_window_depth(lao_v4 unproject, float z) {
    LAO_EXACT float d = (unproject.x - z * unproject.z) / (z * unproject.w - unproject.y);
    return d;
}
/* Depth buffer value of a fragment moved back to view depth z, reversed or not: never so far that
   the cleared buffer would hide it. */
LAO_FN float lao_halo_depth(lao_v4 unproject, float z) {
    float d = lao_window_depth(unproject, z);
    d = d < 0.99999994f ? d : 0.99999994f;
    return d > 1.0e-30f ? d : 1.0e-30f;
}

/* ---- trails (METHODS 2.7, 9.1; Koehler 2017, 4.1; Lawonn 2014, 5.2) */
#define LAO_TRAIL_NONE 0
#define LAO_TRAIL_TAPER 1
#define LAO_TRAIL_OPACITY 2
#define LAO_TRAIL_HIGHLIGHT 3
/* The time of the frame within its period; itself where there is none. */
LAO_FN float lao_trail_now(float time, float period) {
    LAO_EXACT float now = time - period * lao_floor(time / period);
    return period > 0.0f ? now : time;
}
/* What to take from t - now to bring it nearest to 0: whole periods. */
LAO_FN float lao_trail_shift(float t, float now, float period) {
    LAO_EXACT float shift = period * lao_floor((t - now) / period + 0.5f);
    return period > 0.0f ? shift : 0.0f;
}
/* |t - now|, to the nearest repetition. */
LAO_FN float lao_trail_distance(float t, float now, float period) {
    LAO_EXACT float distance = lao_abs(t - now - lao_trail_shift(t, now, period));
    return distance;
}
/* The part of a segment, 0 .. 1 from its start to its end, that a trail covers; first >= last:
   none. */
struct lao_trail_part {
    float first, last;
};
#ifndef LAO_GLSL
typedef struct lao_trail_part lao_trail_part;
#endif
/* t1, t2: times of the segment's ends; |t - now| <= length is covered, to the nearest repetition of
   the segment's middle. */
LAO_FN lao_trail_part lao_trail_clip(float t1, float t2, float now, float length, float period) {
    lao_trail_part part;
    LAO_EXACT float middle = 0.5f * t1 + 0.5f * t2;
    float shift = lao_trail_shift(middle, now, period);
    LAO_EXACT float a = t1 - now - shift;
    LAO_EXACT float b = t2 - now - shift;
    part.first = 0.0f;
    part.last = 1.0f;
    if (period > 0.0f && 2.0f * length >= period) {
        return part;
    }
    if (!(lao_min(a, b) <= length && lao_max(a, b) >= -length)) {
        part.last = 0.0f;
        return part;
    }
    if (lao_abs(a) > length) {
        LAO_EXACT float u = ((a < 0.0f ? -length : length) - a) / (b - a);
        part.first = lao_clamp01(u);
    }
    if (lao_abs(b) > length) {
        LAO_EXACT float u = ((b < 0.0f ? -length : length) - a) / (b - a);
        part.last = lao_clamp01(u);
    }
    return part;
}
/* Width of a trail at q = |t - now| / length: 1 up to `start`, then falling to `least` at 1, 0
   beyond. */
LAO_FN float lao_trail_width(float q, float start, float least) {
    LAO_EXACT float width = 1.0f - (1.0f - least) * lao_max(q - start, 0.0f) / (1.0f - start);
    return q <= 1.0f ? width : 0.0f;
}
/* Opacity of the fade that tapering replaces: 1 up to `start`, then falling to 0 at 1. */
LAO_FN float lao_trail_opacity(float q, float start) {
    return lao_trail_width(q, start, 0.0f);
}
/* Least opacity that is drawn at a pixel, (n + 1/2) / 16: an ordered pattern of 4 x 4 in which each
   2 x 2 has a quarter, so that supersampling averages it. */
LAO_FN float lao_screen_door(lao_uint x, lao_uint y) {
    lao_uint d = x ^ y;
    lao_uint n = ((d & 1u) << 3u) | ((y & 1u) << 2u) | (d & 2u) | ((y >> 1u) & 1u);
    LAO_EXACT float least = (LAO_F(n) + 0.5f) * 0.0625f;
    return least;
}
/* Brightness of a line at |t - now|: exp(-distance^2 / beta), clamped to [1/4, 1]. */
LAO_FN float lao_trail_highlight(float distance, float beta) {
    LAO_EXACT float x = -1.44269504f * distance * distance / beta;
    return lao_max(lao_exp2(x), 0.25f);
}
/* The colour half-way to the grey of its luminance. */
LAO_FN lao_v3 lao_desaturate(lao_v3 color) {
    LAO_EXACT float grey = 0.2126f * color.x + 0.7152f * color.y + 0.0722f * color.z;
    LAO_EXACT float x = 0.5f * color.x + 0.5f * grey;
    LAO_EXACT float y = 0.5f * color.y + 0.5f * grey;
    LAO_EXACT float z = 0.5f * color.z + 0.5f * grey;
    return lao_v3_make(x, y, z);
}
/* LAO_SHARED_END */
