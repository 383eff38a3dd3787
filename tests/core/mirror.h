/* The shared functions on random inputs, in the dialect of the shared text: C and GLSL compile
   these very lines. Row = group of functions, n = number of the input; the inputs come from the
   counter-based hash, so that nothing has to be uploaded. */
#define MIRROR_ROWS 50u
#define MIRROR_INPUTS 1024u

/* Number k of input n: mostly even in [low, high], now and then an end or 0. */
LAO_FN float mirror_in(lao_uint n, lao_uint k, float low, float high) {
    lao_uint h = lao_hash(n * 131u + k * 7919u + 17u);
    lao_uint kind = lao_hash(h) & 31u;
    LAO_EXACT float r = low + (high - low) * lao_unit_float(h);
    if (kind == 0u) {
        return low;
    }
    if (kind == 1u) {
        return high;
    }
    return kind == 2u && low < 0.0f ? 0.0f : r;
}
LAO_FN lao_v3 mirror_v3(lao_uint n, lao_uint k, float size) {
    return lao_v3_make(mirror_in(n, k, -size, size), mirror_in(n, k + 1u, -size, size),
                       mirror_in(n, k + 2u, -size, size));
}
LAO_FN lao_v4 mirror_v4(lao_uint n, lao_uint k, float low, float high) {
    return lao_v4_make(mirror_in(n, k, low, high), mirror_in(n, k + 1u, low, high),
                       mirror_in(n, k + 2u, low, high), mirror_in(n, k + 3u, low, high));
}
LAO_FN lao_v3 mirror_unit(lao_uint n, lao_uint k) {
    return lao_v3_unit(mirror_v3(n, k, 1.0f), lao_v3_make(0.0f, 0.0f, 1.0f));
}
/* A direction on the screen, now and then none. */
LAO_FN lao_v2 mirror_axial(float turn, float known) {
    lao_v2 axial = lao_v2_make(lao_cos_turns(turn), lao_sin_turns(turn));
    if (known < 0.1f) {
        axial = lao_v2_make(0.0f, 0.0f);
    }
    return axial;
}
LAO_FN float mirror_bool(bool b) {
    return b ? 1.0f : 0.0f;
}
/* A word in two halves, which floats hold as they are. */
LAO_FN lao_v4 mirror_word(lao_uint word, float z, float w) {
    return lao_v4_make(LAO_F(LAO_I(word >> 16u)), LAO_F(LAO_I(word & 65535u)), z, w);
}
LAO_FN lao_v4 mirror_from_v3(lao_v3 v, float w) {
    return lao_v4_make(v.x, v.y, v.z, w);
}

/* Rows that share a computation stand together, so that a shader holds it once: compilers need long
 * for this one. */
LAO_FN lao_v4 mirror(lao_uint row, lao_uint n) {
    float a = mirror_in(n, 0u, -1.0f, 1.0f);
    float b = mirror_in(n, 1u, -1.0f, 1.0f);
    float u = mirror_in(n, 2u, 0.0f, 1.0f);
    float v = mirror_in(n, 3u, 0.0f, 1.0f);
    lao_v3 p = mirror_v3(n, 4u, 10.0f);
    lao_v3 q = mirror_v3(n, 8u, 10.0f);
    lao_v3 e = mirror_unit(n, 12u);
    lao_v3 f = mirror_unit(n, 16u);
    lao_v3 g = mirror_unit(n, 20u);
    lao_v4 c = mirror_v4(n, 24u, -1.0f, 1.0f);
    lao_v4 d = mirror_v4(n, 28u, 0.0f, 1.0f);
    float one = (n & 3u) == 0u ? 1.0f : 0.0f;
    lao_int exponent = LAO_I(lao_hash(n) & 1023u);
    if (row == 0u) {
        return mirror_from_v3(p, a);
    }
    if (row == 1u) {
        return mirror_from_v3(lao_v3_unit(p, q), lao_v3_dot(p, q));
    }
    if (row == 2u) {
        return mirror_from_v3(lao_v3_cross(p, q), lao_v2_dot(lao_v2_make(a, b), lao_v2_make(u, v)));
    }
    if (row == 3u) {
        return mirror_from_v3(lao_v3_along(p, q, a), lao_clamp01(2.0f * b));
    }
    if (row == 4u || row == 5u) {
        lao_m4 m;
        m.x = c;
        m.y = d;
        m.z = lao_v4_make(a, v, b, u);
        m.w = lao_v4_make(q.x, q.y, q.z, 1.0f);
        if (row == 4u) {
            return mirror_from_v3(lao_transform(m, p), lao_hermite(2.0f * a));
        }
        return lao_project(m, p);
    }
    if (row == 6u) {
        return lao_v4_make(lao_cos_turns(16.0f * a), lao_sin_turns(16.0f * b), lao_cos_turns(u),
                           lao_sin_turns(v));
    }
    if (row == 7u) {
        float x = lao_exp2(130.0f * a);
        return lao_v4_make(x, lao_exp2(3.0f * b), lao_log2(x), lao_log2(u));
    }
    if (row == 8u) {
        return lao_v4_make(lao_atan2(a, b), lao_atan2(u, 100.0f * b), lao_acos(a),
                           lao_acos(2.0f * b));
    }
    if (row == 9u) {
        return lao_v4_make(lao_power(u, exponent), lao_power(1.0f - v * 0.01f, exponent),
                           lao_srgb_decode(v), 0.0f);
    }
    if (row == 10u) {
        lao_uint h = lao_hash(n);
        return lao_v4_make(LAO_F(h >> 12u), LAO_F(h & 4095u), lao_unit_float(h),
                           LAO_F(lao_sample_count(n & 127u, (n >> 7u) & 7u)));
    }
    if (row == 11u) {
        return mirror_from_v3(lao_sphere_point(u, v), lao_gauss_weight(LAO_I(n & 3u) - 1));
    }
    if (row == 12u) {
        return mirror_from_v3(lao_pixel_noise(n, LAO_U(exponent)), 0.0f);
    }
    if (row >= 13u && row <= 15u) {
        lao_int align = LAO_I(n % 3u);
        lao_v2 direction = align == LAO_ALIGN_PAPER ? lao_v2_make(u, d.y) : mirror_axial(a, v);
        lao_uint word = lao_level_pack(1.2f * d.x - 0.1f, direction, align);
        if (row == 13u) {
            return mirror_word(word, lao_level_depth(word), mirror_bool(lao_level_known(word)));
        }
        word = (n & 7u) == 0u ? 0u : word;
        if (row == 14u) {
            return lao_level_child(word, align);
        }
        return mirror_word(
            lao_level_word(lao_v4_make(0.3f * direction.x, 0.3f * direction.y, one, d.z), align),
            lao_level_nearer(word, lao_hash(n)), d.x);
    }
    if (row == 16u) {
        lao_v2 alpha = lao_axial_alpha(mirror_axial(a, v));
        lao_v2 unit = lao_axial_unit(lao_v2_make(a * v, b * v));
        return lao_v4_make(alpha.x, alpha.y, unit.x, unit.y);
    }
    if (row == 17u) {
        lao_v2 mean = lao_alpha_mean(lao_v2_make(u, (n & 7u) == 0u ? 0.0f : v));
        return lao_v4_make(mean.x, mean.y, lao_axial_difference(lao_hash(n), lao_hash(n + 7u)),
                           lao_alpha_difference(lao_hash(n), lao_hash(n + 7u)));
    }
    if (row == 18u) {
        return mirror_from_v3(lao_signed_pack(e), 0.0f);
    }
    if (row == 19u) {
        return mirror_from_v3(lao_signed_unpack(d), 0.0f);
    }
    if (row == 20u || row == 21u) {
        lao_level_sum sum = lao_level_sum_start(lao_v3_make(0.0f, 0.0f, 0.0f));
        sum = lao_level_sum_add(sum, d, e, lao_gauss_weight(0));
        sum = lao_level_sum_add(sum, lao_v4_make(a, b, one * u, v), f,
                                lao_gauss_weight(LAO_I(n & 3u) - 1));
        sum = lao_level_sum_add(sum, lao_v4_make(c.x, c.y, lao_max(c.z, 0.0f), d.w), g, 0.25f);
        if (row == 20u) {
            return lao_level_sum_mean(sum);
        }
        return mirror_from_v3(sum.tangent, sum.weight);
    }
    if (row == 22u) {
        lao_v4 depth = lao_v4_make(10.0f * a, v * 0.1f + 0.001f, 100.0f * u, 0.0f);
        lao_v2 slope = lao_pixel_slope(c, 640.0f * u, 480.0f * v);
        return lao_v4_make(lao_scene_depth(depth, 30.0f * b), lao_view_depth(depth, v), slope.x,
                           slope.y);
    }
    if (row == 23u) {
        return mirror_from_v3(lao_towards_eye(lao_v2_make(a, 2.0f * b), one),
                              lao_depth_reach(2.0f * u, n & 7u, 8u));
    }
    if (row == 24u) {
        lao_m4 m;
        m.x = lao_v4_make(1.5f, 0.0f, 0.0f, 0.0f);
        m.y = lao_v4_make(0.0f, 1.0f, 0.0f, 0.0f);
        m.z = lao_v4_make(a, b, -1.01f, -1.0f);
        m.w = lao_v4_make(0.0f, 0.0f, -1.01f, 0.0f);
        return lao_v4_make(lao_zoom(m, lao_v4_make(640.0f, 480.0f, 0.0f, 0.0f),
                                    lao_v3_make(p.x, p.y, -20.0f - 9.0f * u), e),
                           lao_pixel_zoom(lao_v4_make(0.0f, 300.0f * b, 0.0f, 0.0f),
                                          lao_v4_make(a, 0.0f, 30.0f, one), v),
                           lao_sample_radius(50.0f * u, 1.5f, v, 2.0f * v, n & 7u), 0.0f);
    }
    if ((row >= 25u && row <= 27u) || row == 47u) { /* any turn, nearly straight, no neighbour */
        lao_v3 other = (n & 3u) == 1u ? lao_v3_add(p, lao_v3_scale(q, 0.1f)) : q;
        lao_line_end end = lao_line_join(lao_v3_scale(e, 30.0f), p,
                                         (n & 7u) == 2u ? lao_v3_make(0.0f, 0.0f, 0.0f) : other, u,
                                         one * 2.0f - 1.0f);
        if (row == 25u) {
            return mirror_from_v3(end.across, end.along.x);
        }
        if (row == 26u) {
            return mirror_from_v3(end.tangent, end.along.y + 16.0f * end.square);
        }
        if (row == 27u) {
            return mirror_from_v3(end.normal, end.along.z);
        }
        return lao_v4_make(end.seen, 0.0f, 0.0f, 0.0f);
    }
    if (row == 28u) {
        return mirror_from_v3(lao_line_normal(e, (n & 15u) == 0u ? e : f), 0.0f);
    }
    if (row == 29u) {
        lao_v2 axial = lao_screen_axial(
            e, lao_v2_make(a, b), lao_v4_make(100.0f + 800.0f * u, 100.0f + 800.0f * v, 0.0f, 0.0f),
            one);
        return lao_v4_make(axial.x, axial.y, 0.0f, 0.0f);
    }
    if (row == 30u) {
        float slope = lao_depth_weight_slope(u, 0.01f * v);
        return lao_v4_make(slope, lao_depth_weight(a, slope), lao_align_weight(v, 20.0f * u, v),
                           lao_align_weight(0.2f * u, 15.0f, 0.1f));
    }
    if (row == 31u) {
        return lao_v4_make(
            lao_light_weight(u * v, b, exponent),
            lao_light_weight_author(e, v, (n & 7u) == 0u ? lao_v3_make(0.0f, 0.0f, 0.0f) : f, g,
                                    exponent),
            lao_light_diffuse(u, v, a), lao_light_specular(u, v, exponent == 0 ? 1 : exponent));
    }
    if (row >= 32u && row <= 36u) {
        lao_v3 direction = lao_sample_direction(n & 7u, (n >> 3u) & 15u, 16u);
        lao_sampler s =
            lao_sampler_make(e, f, g, 90.0f * u, 1.0f / LAO_F(1u << (n & 7u)),
                             lao_floor(400.0f * d.x) + 0.5f, lao_floor(300.0f * d.y) + 0.5f);
        if (row == 32u) {
            return mirror_from_v3(s.x, s.centre.x);
        }
        if (row == 33u) {
            return mirror_from_v3(s.y, s.centre.y);
        }
        if (row == 34u) {
            return mirror_from_v3(s.n, s.r.x);
        }
        lao_tap tap = lao_tap_make(s, direction, lao_v2_make(1.0f / 200.0f, 1.0f / 150.0f));
        if (row == 35u) {
            return lao_v4_make(tap.x, tap.y, tap.n_omega, tap.r_omega);
        }
        return lao_v4_make(tap.at.x, tap.at.y, direction.z,
                           4.0f * lao_turned(1.0f, tap.side) + mirror_bool(tap.counts));
    }
    if (row == 37u) {
        return mirror_from_v3(lao_mirror(p, e), 0.0f);
    }
    if (row == 38u) {
        return mirror_from_v3(lao_shade(lao_v3_make(u, v, d.x), e, f, 0.1f, d.y, d.z, exponent, b),
                              0.0f);
    }
    if (row == 39u) {
        return mirror_from_v3(lao_shade_luminance(lao_v3_make(u, v, d.x), e, f, 0.1f, d.y, b),
                              lao_srgb_encode(d.w));
    }
    if (row == 40u) {
        return lao_over(lao_v4_make(4.0f * u, 4.0f * v, d.x, d.y), 4.0f, d);
    }
    if (row == 41u) {
        lao_v3 rim = lao_rim_corner(a, one > 0.5f, LAO_F(n & 1u), 9.0f * u);
        return mirror_from_v3(rim, lao_rim(lao_v3_make(1.1f * a, 1.1f * b, c.x)));
    }
    if (row == 42u) {
        lao_v2 beside = lao_rim_neighbour(p, lao_v3_scale(e, 30.0f), (n & 15u) == 1u ? e : q,
                                          0.01f + u, one * 2.0f - 1.0f, LAO_F((n >> 2u) & 1u));
        return lao_v4_make(beside.x, beside.y, lao_rim_union(v, lao_v2_make(a, b)), 0.0f);
    }
    if (row == 43u) {
        float begin = lao_halo_begin(0.5f * u, LAO_I(n % 3u));
        float light = lao_halo_light(v, begin, LAO_I(n & 1u));
        return lao_v4_make(begin, light, lao_light_pack(light), lao_light_unpack(d.x));
    }
    if (row == 44u) { /* near and far plane, perspective and orthographic, reversed or not */
        float near_z = 0.01f + d.x;
        float far_z = near_z + 1.0f + 999.0f * d.y;
        bool reversed = (n & 1u) != 0u;
        float range = reversed ? near_z - far_z : far_z - near_z;
        float first = reversed ? far_z : near_z;
        LAO_EXACT float product = -near_z * far_z / range;
        LAO_EXACT float scale = -(near_z + range + first - near_z) / range;
        LAO_EXACT float flat_x = -first / range;
        LAO_EXACT float flat_z = -1.0f / range;
        lao_v4 perspective = lao_v4_make(product, 0.0f, scale, 1.0f);
        lao_v4 flat_ = lao_v4_make(flat_x, -1.0f, flat_z, 0.0f);
        LAO_EXACT float z = near_z + u * (far_z - near_z);
        return lao_v4_make(lao_window_depth(perspective, z), lao_window_depth(flat_, z),
                           lao_halo_depth(perspective, 1.1f * z),
                           lao_halo_displacement(u, v, LAO_I(n % 3u)));
    }
    if (row == 45u) {
        float period = (n & 3u) == 1u ? 0.0f : 100.0f + 900.0f * u;
        float now = lao_trail_now(5000.0f * a, period);
        lao_trail_part part =
            lao_trail_clip(2000.0f * b, 2000.0f * b + 60.0f * c.x, now,
                           (n & 7u) == 2u ? 600.0f * v : 1.0f + 2000.0f * v * v, period);
        return lao_v4_make(now, part.first, part.last,
                           lao_trail_distance(3000.0f * c.y, now, period));
    }
    if (row == 46u) {
        lao_v3 grey = lao_desaturate(lao_v3_make(d.x, d.y, d.z));
        return mirror_from_v3(grey, lao_trail_shift(3000.0f * a, 900.0f * u, 500.0f * v + 1.0f));
    }
    if (row == 47u) {
        return lao_v4_make(lao_trail_width(1.1f * u, 0.999f * v, d.x),
                           lao_trail_opacity(u, 0.5f * v),
                           lao_trail_highlight(200.0f * a, 1.0f + 3000.0f * v),
                           lao_screen_door(n, LAO_U(exponent)));
    }
    lao_int show = LAO_I(n % 9u);
    return lao_v4_make(mirror_bool(lao_uses_visibility(show)), mirror_bool(lao_uses_depth(show)),
                       mirror_bool(lao_uses_light(show)), mirror_bool(lao_uses_alignment(show)));
}
