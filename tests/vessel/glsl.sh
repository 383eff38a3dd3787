#!/bin/sh
# Proves that the shared text of lineao.h and sdfvessel.h is GLSL, for OpenGL and for Vulkan, precise or not.
# Usage: glsl.sh GLSLANG
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM
for kind in "330 0" "450 1"; do
    version=${kind% *}
    {
        printf '#version %s\n#define LAO_GLSL 1\n' "$version"
        if [ "$version" = 450 ]; then
            printf '#define LAO_PRECISE 1\nlayout(location = 0) out vec4 result;\n'
        else
            printf 'out vec4 result;\n'
        fi
        for header in lineao.h sdfvessel.h; do
            awk '/^\/\* [A-Z]+_SHARED_BEGIN \*\//{on = 1; next} /^\/\* [A-Z]+_SHARED_END \*\//{on = 0} on' "$root/$header"
        done
        cat <<'GLSL'
void main() {
    lao_v4 a = vec4(gl_FragCoord.xyz, 1.0);
    lao_v4 b = a.yzxw;
    sdv_near n = sdv_near_add(sdv_near_start(1.0), b.xyz, a.xyz, a, b, 0.0);
    sdv_mix m = sdv_mix_add(sdv_mix_start(a), b, n.distance, 0.25);
    result = sdv_push_value(m, a, sdv_push_own(n.advance, 25)) + sdv_triangle_cone(a.xyz, b.xyz, a.zxy, a, b);
}
GLSL
    } >"$work/$version.frag"
    if [ "$version" = 450 ]; then
        "$1" -V --target-env vulkan1.2 -o "$work/out.spv" "$work/$version.frag"
    else
        "$1" "$work/$version.frag"
    fi
done
