#!/usr/bin/env bash
# Writes the shaders of the floors (bench_modules.h) as a C header, at build time:
#   shaders.sh path/to/lineao_shaders.h out.h
# The shared prologue and the vertex stage of the line pass come out of lineao_shaders.h, so that
# they are those that lineao runs. Without glslangValidator there are no words for Vulkan, and
# BENCH_HAVE_WORDS is 0.
set -euo pipefail
export LC_ALL=C
shaders=$1 out=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
words=0
if command -v glslangValidator >/dev/null; then words=1; fi

# text ARRAY: the text that an array of C string literals holds
text() {
  awk -v start="static const char *const $1[] = {" '
    $0 == start {on = 1; found = 1; next}
    on && /^};/ {on = 0}
    on {
      sub(/^ *"/, ""); sub(/\\n",$/, "")
      gsub(/\\"/, "\""); gsub(/\\\\/, "\\"); print
    }
    END {exit !found}' "$shaders" || {
    echo "shaders.sh: $shaders has no $1" >&2
    exit 1
  }
}

# taps SAMPLER LEVEL COUNT RADIUS: reads at literal offsets, a sunflower disc of whole texels
taps() {
  awk -v name="$1" -v level="$2" -v n="$3" -v radius="$4" 'BEGIN {
    for (i = 0; i < n; i++) {
      r = radius * sqrt((i + 0.5) / n); a = 2.39996323 * i
      printf "sum += textureLod(%s, at%d + vec2(%.1f, %.1f) * step%d, 0.0).x;\n", name, level,
        int(r * cos(a) + 100.5) - 100, int(r * sin(a) + 100.5) - 100, level
    }
  }'
}

# The taps of 32 + 16 + 11 samples, and nothing else, of what the occlusion pass reads: a word a
# tap. The radii are those of the benchmark's scene, in texels of a level.
tap_floor() {
  local i counts=(32 16 11) radii=(8 14 12)
  for i in 0 1 2; do echo "LAO_TEX($i, usampler2D, level$i)"; done
  cat <<'END'
LAO_OUT(0, vec4, out_sum)
#ifdef LAO_FRAGMENT
void main() {
ivec2 pixel = LAO_PIXEL;
uint sum = 0u;
END
  for i in 0 1 2; do
    echo "vec2 step$i = 1.0 / vec2(textureSize(level$i, 0));"
    echo "vec2 at$i = (vec2(pixel >> $i) + 0.5) * step$i;"
    taps "level$i" "$i" "${counts[i]}" "${radii[i]}"
  done
  printf 'out_sum = vec4(float(sum));\n}\n#endif\n'
}

# The vertex stage of the line pass without halo and trail, with one flat colour.
lines_floor() {
  text lao_lines_lines | sed '/^LAO_OUT(/,$d; s/^LAO_CONSTANT(.*, \(.*\))/const int \1 = 0;/'
  printf 'LAO_OUT(0, vec4, out_color)\n#ifdef LAO_FRAGMENT\nvoid main() { out_color = vec4(1.0); }\n#endif\n'
}

# A mesh with light at its vertices and one target: what any surface costs.
gouraud_floor() {
  cat <<'END'
LAO_TEX(0, samplerBuffer, points)
LAO_TEX(1, samplerBuffer, normals)
LAO_TEX(2, samplerBuffer, triangles)
LAO_VARYING(0, vec4, at_color)
#ifdef LAO_VERTEX
void main() {
int corner = int(LAO_VERTEX_INDEX);
int vertex = int(texelFetch(triangles, corner / 3)[corner % 3]);
vec3 p = texelFetch(points, vertex).xyz;
vec3 v = normalize(lao_frame.world.w.xyz - p);
at_color = vec4(vec3(abs(dot(normalize(texelFetch(normals, vertex).xyz), v))), 1.0);
lao_emit(lao_project(lao_frame.projection, lao_transform(lao_frame.view, p)));
}
#endif
LAO_OUT(0, vec4, out_color)
#ifdef LAO_FRAGMENT
void main() { out_color = at_color; }
#endif
END
}

# fetch_floor FETCHES WRITES: nothing but these, of texels side by side.
fetch_floor() {
  local i
  echo "LAO_TEX(0, sampler2D, image)"
  for ((i = 0; i < $2; i++)); do echo "LAO_OUT($i, vec4, out_$i)"; done
  printf '#ifdef LAO_FRAGMENT\nvoid main() {\nivec2 pixel = LAO_PIXEL;\nvec4 sum = texelFetch(image, pixel, 0);\n'
  for ((i = 1; i < $1; i++)); do echo "sum += texelFetch(image, pixel ^ ivec2($((i % 2)), $((i / 2))), 0);"; done
  for ((i = 0; i < $2; i++)); do echo "out_$i = sum;"; done
  printf '}\n#endif\n'
}
# A ray a pixel to one ball, by its formula, with the outputs of the vessel trace: what any traced
# surface costs.
ball_floor() {
  cat <<'END'
LAO_OUT(0, vec4, out_position)
LAO_OUT(1, vec4, out_normal)
LAO_OUT(2, vec4, out_ray)
#ifdef LAO_FRAGMENT
void main() {
ivec2 pixel = LAO_PIXEL;
lao_v2 slope = lao_pixel_slope(lao_frame.ray, float(pixel.x) + 0.5, float(pixel.y) + 0.5);
lao_v3 origin = lao_ray_origin(lao_frame.world, slope, lao_frame.depth.w);
lao_v3 direction = lao_ray_direction(lao_frame.world, slope, lao_frame.depth.w);
float b = dot(origin, direction);
float h = b * b - dot(origin, origin) + 6400.0;
out_position = vec4(0.0, 0.0, 0.0, -1.0);
out_normal = vec4(0.0);
out_ray = vec4(0.0);
if (h >= 0.0) {
out_ray.x = -b - sqrt(h);
out_position = vec4(origin + out_ray.x * direction, 0.0);
out_normal = vec4(out_position.xyz / 80.0, 0.0);
}
}
#endif
END
}

# spirv NAME STAGE SUFFIX: the words of one stage as a C array
spirv() {
  {
    printf '#version 450\n#define LAO_GLSL 1\n#define LAO_PRECISE 1\n#define LAO_%s 1\n' "$2"
    cat "$work/prologue" "$work/$1.body"
  } >"$work/$1.$3"
  glslangValidator -V --target-env vulkan1.2 -g0 -x -o "$work/words" "$work/$1.$3" >"$work/log" || {
    cat "$work/log" >&2
    exit 1
  }
  printf 'static const uint32_t bench_words_%s_%s[] = {\n' "$1" "$3"
  cat "$work/words"
  echo "};"
}

# names MACRO NAME: the last argument of every LAO_... of a shader
names() { sed -n "s/^$1(.*, *\([A-Za-z_0-9]*\)).*/\1/p" "$work/$2.body"; }

# list TYPE ARRAY WORD...: an array of words, if there are any
list() {
  local type=$1 array=$2
  shift 2
  if [ $# -gt 0 ]; then
    printf 'static %s %s[] = {' "$type" "$array"
    printf '%s, ' "$@"
    echo "};"
  fi
}

# stage NAME SUFFIX: the fields of a lao_shader_stage
stage() {
  printf '{bench_text_%s, sizeof bench_text_%s / sizeof *bench_text_%s, ' "$1" "$1" "$1"
  if [ $words = 1 ]; then
    printf 'bench_words_%s_%s, sizeof bench_words_%s_%s / 4}' "$1" "$2" "$1" "$2"
  else
    printf 'NULL, 0}'
  fi
}

# shader NAME has_vertex: its arrays to standard output, its row to $work/rows
shader() {
  local name=$1 constants textures types
  printf 'static const char *const bench_text_%s[] = {\n' "$name"
  sed 's/\\/\\\\/g; s/"/\\"/g; s/.*/    "&\\n",/' "$work/$name.body"
  echo "};"
  if [ $words = 1 ]; then
    if [ "$2" = 1 ]; then spirv "$name" VERTEX vert; fi
    spirv "$name" FRAGMENT frag
  fi
  mapfile -t constants < <(names LAO_CONSTANT "$name" | sed 's/^lao_constant_\(.*\)/"\1"/')
  mapfile -t textures < <(names LAO_TEX "$name" | sed 's/.*/"&"/')
  mapfile -t types < <(sed -n 's/^LAO_TEX([0-9]*, *\([A-Za-z0-9]*\),.*/\1/p' "$work/$name.body" |
    sed 's/.*Buffer/LAO_TEXTURE_BUFFER/; s/.*sampler2D/LAO_TEXTURE_2D/')
  list 'const char *const' "bench_constants_$name" "${constants[@]}"
  list 'const char *const' "bench_textures_$name" "${textures[@]}"
  list 'const lao_texture_type' "bench_types_$name" "${types[@]}"
  {
    printf '    {"floor_%s", ' "$name"
    if [ ${#constants[@]} -gt 0 ]; then printf 'bench_constants_%s, ' "$name"; else printf 'NULL, '; fi
    if [ ${#textures[@]} -gt 0 ]; then textures[0]="bench_textures_$name, bench_types_$name"; else textures=("NULL, NULL"); fi
    printf '%d, %s, %d, %d,\n     ' "${#constants[@]}" "${textures[0]}" "${#types[@]}" "$(names LAO_OUT "$name" | wc -l)"
    if [ "$2" = 1 ]; then stage "$name" vert; else printf '{NULL, 0, NULL, 0}'; fi
    printf ',\n     '
    stage "$name" frag
    printf ',\n     bench_prologue, sizeof bench_prologue / sizeof *bench_prologue},\n'
  } >>"$work/rows"
}

{ text lao_shader_prologue; text lao_prologue_lines; } >"$work/prologue"
lines_floor >"$work/lines.body"
tap_floor >"$work/taps.body"
gouraud_floor >"$work/gouraud.body"
fetch_floor 1 1 >"$work/fetch.body"
fetch_floor 8 1 >"$work/fetch8.body"
fetch_floor 1 4 >"$work/write4.body"
ball_floor >"$work/ball.body"
{
  echo "/* GENERATED by bench/shaders.sh */"
  echo "/* clang-format off */"
  echo "#define BENCH_HAVE_WORDS $words"
  echo "static const char *const bench_prologue[] = {"
  text lao_prologue_lines | sed 's/\\/\\\\/g; s/"/\\"/g; s/.*/    "&\\n",/'
  echo "};"
  shader lines 1
  shader taps 0
  shader gouraud 1
  shader fetch 0
  shader fetch8 0
  shader write4 0
  shader ball 0
  echo "static const lao_shader bench_shaders[] = {"
  cat "$work/rows"
  echo "};"
  echo "/* clang-format on */"
} >"$work/header"
cp "$work/header" "$out"
