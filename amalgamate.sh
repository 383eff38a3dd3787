#!/bin/sh
# Makes lineao_shaders.h, sdfvessel_shaders.h and vesselsurface_shaders.h (GLSL lines and SPIR-V words of every pass of a
# module, from the headers' shared text and shaders/), dist/lineao_all.h (core, line shaders and executors in one file), and
# the generated parts of README.md and docs/algorithm.md. The same inputs give the same bytes: no clock, no locale, no paths.
#   ./amalgamate.sh            write all
#   ./amalgamate.sh --check    prove that the committed files are current and that dist/ compiles
# Needs cc, awk, od, glslangValidator, spirv-opt.
# shellcheck disable=SC2046,SC2086 # lists are split into words on purpose
set -eu
LC_ALL=C
export LC_ALL
cd "$(dirname "$0")"

# Shaders by module; a module's header is where its shared text is. Each module has a file of its own, so that who draws
# lines alone copies no more.
MODULES="lines vessel surface"
lines_shaders="fullscreen import_depth export_depth cover far lines lines_rim lines_halo level_zero level_one level_up occlusion smooth shade resolve present"
vessel_shaders="vessel_lists vessel_sum vessel_start vessel_words vessel_rows vessel_columns vessel_grid vessel_trace vessel_carve vessel_mesh vessel_drawn vessel_depth vessel_pull vessel_push vessel_fill vessel_surface vessel_gather vessel_guide vessel_recall vessel_recall_up vessel_phase vessel_sweep vessel_uv vessel_ink vessel_shade"
vessel_header="sdfvessel.h"
surface_shaders="surface_measure surface_mesh surface_nearest surface_left surface_layers surface_shadow surface_effect surface_focus surface_tiles surface_blur"
surface_header="vesselsurface.h"
lines_header="" # lineao.h's text stands in front of all
shaders_of() {
    case $1 in
        lines) echo "$lines_shaders" ;;
        vessel) echo "$vessel_shaders" ;;
        surface) echo "$surface_shaders" ;;
    esac
}
header_of() {
    case $1 in
        lines) echo "$lines_header" ;;
        vessel) echo "$vessel_header" ;;
        surface) echo "$surface_header" ;;
    esac
}

file_of() {
    case $1 in
        lines) echo lineao_shaders.h ;;
        *) header_of "$1" | sed 's/\.h$/_shaders.h/' ;;
    esac
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM
die() {
    printf 'amalgamate.sh: %s\n' "$*" >&2
    exit 1
}

command -v glslangValidator >/dev/null || die "glslangValidator is missing (Debian package glslang-tools)"
command -v spirv-opt >/dev/null || die "spirv-opt is missing (Debian package spirv-tools)"

# Comments and blank lines go, indentation too: shorter text, the same tokens.
strip() {
    awk '{
        line = $0
        out = ""
        while (length(line)) {
            if (inside) {
                i = index(line, "*/")
                if (!i) { line = ""; break }
                inside = 0
                line = substr(line, i + 2)
            } else {
                i = index(line, "/*")
                if (!i) { out = out line; line = ""; break }
                out = out substr(line, 1, i - 1)
                inside = 1
                line = substr(line, i + 2)
            }
        }
        sub(/^[ \t]+/, "", out)
        sub(/[ \t]+$/, "", out)
        if (length(out)) print out
    }'
}

# No shared function writes its parameters; saying so passes them by value, which saves a sixth of the words of SPIR-V.
constant_parameters() {
    awk '/^LAO_FN / {
        while (index($0, ")") == 0 && (getline line) > 0) $0 = $0 " " line
        first = index($0, "(")
        last = index($0, ")")
        parameters = substr($0, first + 1, last - first - 1)
        if (parameters != "" && parameters != "void") {
            gsub(/, */, ", const ", parameters)
            $0 = substr($0, 1, first) "const " parameters substr($0, last)
        }
    } {print}'
}

# The shared text of headers.
make_shared() {
    for header in "$@"; do
        awk '/^\/\* [A-Z]+_SHARED_BEGIN \*\//{on = 1; next} /^\/\* [A-Z]+_SHARED_END \*\//{on = 0} on' "$header"
    done | strip | constant_parameters
}

c_lines() { # C string literals, one a line
    awk '{gsub(/\\/, "\\\\"); gsub(/"/, "\\\""); printf "    \"%s\\n\",\n", $0}'
}

# name, stage (VERTEX|FRAGMENT), suffix (vert|frag): words as a C array body into $work/name.suffix.words
spirv() {
    {
        printf '#version 450\n#define LAO_GLSL 1\n#define LAO_PRECISE 1\n#define LAO_%s 1\n' "$2"
        cat "$work/prologue" "$work/$module.prologue" "$work/$1.body"
    } >"$work/$1.$3"
    glslangValidator -V --target-env vulkan1.2 -g0 -o "$work/$1.$3.spv" "$work/$1.$3" >"$work/log" ||
        { cat "$work/log" >&2; die "shaders/$1.glsl does not compile as $2"; }
    # without what the prologue holds and the shader does not call, and without copies of variables; arithmetic stays as it is
    spirv-opt --target-env=vulkan1.2 --eliminate-dead-functions --eliminate-local-single-block \
        --eliminate-local-single-store --eliminate-local-multi-store --eliminate-dead-code-aggressive \
        --eliminate-dead-const --compact-ids -o "$work/$1.$3.spv" "$work/$1.$3.spv" ||
        die "spirv-opt refuses shaders/$1.glsl as $2"
    od -An -v -tu4 -w64 "$work/$1.$3.spv" | awk '{for (i = 1; i <= NF; i++) printf "%s,", $i; print ""}' >"$work/$1.$3.words"
}

# The words of $module that macros of two letters shorten most, into $work/short: name and word. A quarter of the file is saved.
choose_macros() {
    for shader in $(shaders_of "$module"); do
        cat "$work/$shader".*.words
    done | awk -F, '
        {for (i = 1; i < NF; i++) count[$i]++}
        END {for (word in count) {
            saved = count[word] * (length(word) - 2) - length(word) - 25 # #define and #undef
            if (saved > 0) printf "%d %s\n", saved, word
        }}' | sort -k1,1nr -k2,2n | awk '
        BEGIN {n = split("a b c d e f g h i j k l m n o p q r s t u v w x y z " \
                         "A B C D E F G H I J K L M N O P Q R S T U V W X Y Z 0 1 2 3 4 5 6 7 8 9", second, " ")}
        NR <= 3 * n {print substr("wxz", int((NR - 1) / n) + 1, 1) second[(NR - 1) % n + 1], $2}' >"$work/short"
}

word_macros() { # define|undef
    printf '#ifdef LINEAO_SHADERS_SPIRV\n'
    awk -v what="$1" '{print "#" what, $1 (what == "define" ? " " $2 : "")}' "$work/short"
    printf '#endif\n'
}

shorten() { # lines of words alone; the others stay
    awk -F, -v short="$work/short" '
        BEGIN {while ((getline line < short) > 0) {split(line, pair, " "); name[pair[2]] = pair[1]}}
        /^[0-9]+,/ {for (i = 1; i < NF; i++) printf "%s,", $i in name ? name[$i] : $i; print ""; next}
        {print}'
}

names() { # second and further arguments of a macro: names MACRO file
    sed -n "s/^$1([0-9]*, *\([^)]*\)).*/\1/p" "$2"
}

make_shader() { # arrays and the table row of one shader of $module
    name=$1
    awk '/^LAO_INCLUDE / {while ((getline line < ("shaders/" $2)) > 0) print line; next} {print}' "shaders/$name.glsl" | strip |
        awk -v levels="$work/levels" '/^LAO_GENERATED_LEVELS$/ {while ((getline line < levels) > 0) print line; next} {print}' \
            >"$work/$name.body"
    has_vertex=$(grep -c '^#ifdef LAO_VERTEX' "$work/$name.body" || true)
    has_fragment=$(grep -c '^#ifdef LAO_FRAGMENT' "$work/$name.body" || true)
    printf '\n/* %s */\n#ifdef LINEAO_SHADERS_GLSL\nstatic const char *const lao_lines_%s[] = {\n' "$name" "$name"
    c_lines <"$work/$name.body"
    printf '};\n#endif\n#ifdef LINEAO_SHADERS_SPIRV\n'
    if [ "$has_vertex" -gt 0 ]; then
        spirv "$name" VERTEX vert
        printf 'static const uint32_t lao_words_%s_vertex[] = {\n' "$name"
        cat "$work/$name.vert.words"
        printf '};\n'
    fi
    if [ "$has_fragment" -gt 0 ]; then
        spirv "$name" FRAGMENT frag
        printf 'static const uint32_t lao_words_%s_fragment[] = {\n' "$name"
        cat "$work/$name.frag.words"
        printf '};\n'
    fi
    printf '#endif\n'
    constants=$(names LAO_CONSTANT "$work/$name.body" | sed 's/^lao_constant_//')
    textures=$(names LAO_TEX "$work/$name.body" | sed 's/.*, *//')
    types=$(names LAO_TEX "$work/$name.body" | sed 's/,.*//; s/^.*Buffer$/LAO_TEXTURE_BUFFER/; s/^[a-z]*sampler2D$/LAO_TEXTURE_2D/')
    [ -z "$constants" ] || { printf 'static const char *const lao_constants_%s[] = {' "$name"; printf '"%s", ' $constants; printf '};\n'; }
    [ -z "$textures" ] || {
        printf 'static const char *const lao_textures_%s[] = {' "$name"; printf '"%s", ' $textures; printf '};\n'
        printf 'static const lao_texture_type lao_types_%s[] = {' "$name"; printf '%s, ' $types; printf '};\n'
    }
    list() { [ -z "$2" ] && printf 'NULL' || printf '%s_%s' "$1" "$name"; }
    count() { set -- $1; printf '%d' $#; }
    stage() { # vertex|fragment present
        if [ "$2" -gt 0 ]; then
            printf '{LAO_GLSL_STAGE(lao_lines_%s) LAO_SPIRV_STAGE(lao_words_%s_%s)}' "$name" "$name" "$1"
        else
            printf '{NULL, 0, NULL, 0}'
        fi
    }
    {
        printf '    {"%s", %s, %s, %s, %s, %s, %s,\n     ' "$name" \
            "$(list lao_constants "$constants")" "$(count "$constants")" \
            "$(list lao_textures "$textures")" "$(list lao_types "$textures")" "$(count "$textures")" \
            "$(names LAO_OUT "$work/$name.body" | wc -l | tr -d ' ')"
        stage vertex "$has_vertex"
        printf ',\n     '
        stage fragment "$has_fragment"
        printf ',\n     LAO_MODULE_PROLOGUE(%s)},\n' "$module"
    } >>"$work/rows"
}

# What all shaders begin with ($work/prologue), what those of a module go on with, and the unrolled levels.
make_prologues() {
    { make_shared lineao.h; strip <shaders/prologue.glsl; } >"$work/prologue"
    for module in $MODULES; do
        {
            make_shared $(header_of "$module")
            "$work/shader_text" settings "$module"
            [ ! -e "shaders/$module.glsl" ] || [ "$module" = lines ] || strip <"shaders/$module.glsl"
        } >"$work/$module.prologue"
    done
    "$work/shader_text" levels | strip >"$work/levels"
}

# Arrays of $module on standard output; its rows of the table go into $work/rows.
make_arrays() {
    : >"$work/rows"
    printf '#ifdef LINEAO_SHADERS_GLSL\n/* in front of shaders of the module: its shared text and its settings */\nstatic const char *const lao_prologue_%s[] = {\n' "$module"
    c_lines <"$work/$module.prologue"
    printf '};\n#endif\n'
    for shader in $(shaders_of "$module"); do
        make_shader "$shader"
    done >"$work/shaders"
    choose_macros
    word_macros define
    shorten <"$work/shaders"
    word_macros undef
}

# The file of a further module, which lineao_shaders.h includes twice: for the arrays, and for the rows of the table.
make_module_file() {
    cat <<END
/* Generated by amalgamate.sh from $(header_of "$module") and shaders/. Do not edit: change those and run ./amalgamate.sh. MIT licence.
   A part of lineao_shaders.h, which finds it when it lies beside. */
/* clang-format off */
#ifndef LAO_SHADER_ROWS
END
    make_arrays
    printf '#else\n'
    cat "$work/rows"
    printf '#endif\n'
}

make_shaders_header() {
    module=lines
    cat <<'END'
/* Generated by amalgamate.sh from lineao.h and shaders/. Do not edit: change those and run ./amalgamate.sh. MIT licence.
   Define LINEAO_SHADERS_GLSL or LINEAO_SHADERS_SPIRV (or both) before including; the other text is left out.
   Shaders of further modules are in files of their own (sdfvessel_shaders.h, vesselsurface_shaders.h), taken when they lie
   beside this one; for compilers without __has_include define LINEAO_SHADERS_OF_sdfvessel and the like. */
/* clang-format off */
#ifndef LINEAO_SHADERS_H
#define LINEAO_SHADERS_H
#include "lineao.h"

#ifdef LINEAO_SHADERS_GLSL
#define LAO_GLSL_STAGE(lines) lines, (uint32_t)(sizeof lines / sizeof lines[0]),
#define LAO_MODULE_PROLOGUE(module) lao_prologue_##module, (uint32_t)(sizeof lao_prologue_##module / sizeof lao_prologue_##module[0])
#else
#define LAO_GLSL_STAGE(lines) NULL, 0,
#define LAO_MODULE_PROLOGUE(module) NULL, 0
#endif
#ifdef LINEAO_SHADERS_SPIRV
#define LAO_SPIRV_STAGE(words) words, (uint32_t)(sizeof words / sizeof words[0])
#else
#define LAO_SPIRV_STAGE(words) NULL, 0
#endif

#ifdef LINEAO_SHADERS_GLSL
/* the shared text of lineao.h and the macros: in front of every stage */
static const char *const lao_shader_prologue[] = {
END
    c_lines <"$work/prologue"
    printf '};\nstatic const uint32_t lao_shader_prologue_count = (uint32_t)(sizeof lao_shader_prologue / sizeof lao_shader_prologue[0]);\n#endif\n'
    make_arrays
    for other in $MODULES; do
        [ "$other" != lines ] || continue
        part=$(file_of "$other")
        macro=LINEAO_SHADERS_OF_${part%_shaders.h}
        printf '\n#if !defined(%s) && defined(__has_include)\n#if __has_include("%s")\n#define %s\n#endif\n#endif\n' "$macro" "$part" "$macro"
        printf '#ifdef %s\n#include "%s"\n#endif\n' "$macro" "$part"
    done
    printf '\n#define LAO_SHADER_ROWS\nstatic const lao_shader lao_shaders[] = {\n'
    cat "$work/rows"
    for other in $MODULES; do
        [ "$other" != lines ] || continue
        part=$(file_of "$other")
        printf '#ifdef LINEAO_SHADERS_OF_%s\n#include "%s"\n#endif\n' "${part%_shaders.h}" "$part"
    done
    printf '};\nstatic const uint32_t lao_shader_count = (uint32_t)(sizeof lao_shaders / sizeof lao_shaders[0]);\n\n'
    printf '#undef LAO_SHADER_ROWS\n#undef LAO_GLSL_STAGE\n#undef LAO_SPIRV_STAGE\n#undef LAO_MODULE_PROLOGUE\n#endif\n'
}

inlined() { # a file without its includes of our own files
    printf '/* ==== begin file %s ==== */\n' "$1"
    sed '/^#include "lineao[a-z_]*\.h"/d' "$1"
    printf '/* ==== end file %s ==== */\n' "$1"
}

make_all() {
    printf '/* lineao in one file. Generated by amalgamate.sh; do not edit. Version %s.\n' \
        "$(sed -n 's/^#define LAO_VERSION \([0-9]*\).*/\1/p' lineao.h)"
    printf '   #define LINEAO_IMPLEMENTATION for the core, LINEAO_GL_IMPLEMENTATION and/or LINEAO_VK_IMPLEMENTATION for the backends,\n'
    printf '   in one C file. LINEAO_VK_IMPLEMENTATION needs vulkan/vulkan_core.h. */\n'
    printf '#if defined(LINEAO_GL_IMPLEMENTATION) && !defined(LINEAO_SHADERS_GLSL)\n#define LINEAO_SHADERS_GLSL\n#endif\n'
    printf '#if defined(LINEAO_VK_IMPLEMENTATION) && !defined(LINEAO_SHADERS_SPIRV)\n#define LINEAO_SHADERS_SPIRV\n#endif\n'
    inlined lineao.h
    printf '#if defined(LINEAO_GL_IMPLEMENTATION) || defined(LINEAO_VK_IMPLEMENTATION)\n'
    inlined "$1"
    printf '#endif\n#ifdef LINEAO_GL_IMPLEMENTATION\n'
    inlined lineao_gl.c
    printf '#endif\n#ifdef LINEAO_VK_IMPLEMENTATION\n'
    inlined lineao_vk.c
    printf '#endif\n/*\n'
    cat LICENSE
    printf '*/\n'
}

# Text between `<!-- NAME begin -->` and `<!-- NAME end -->` of a document is made here too: document, name, kind of fence
documented() {
    "$work/shader_text" "$2" >"$work/insert"
    awk -v name="$2" -v fence="$3" -v insert="$work/insert" '
        $0 == "<!-- " name " end -->" {inside = 0}
        !inside {print}
        $0 == "<!-- " name " begin -->" {
            inside = 1
            if (fence != "") print "```" fence
            while ((getline line < insert) > 0) print line
            if (fence != "") print "```"
        }' "$1" >"$work/document"
    if [ "${check-}" ]; then
        cmp -s "$work/document" "$1" || die "$1 is stale: run ./amalgamate.sh and commit it"
    else
        cmp -s "$work/document" "$1" || cp "$work/document" "$1"
    fi
}

[ "${1-}" != --check ] || check=1
${CC:-cc} -std=c99 -O1 -ffp-contract=off -I. -o "$work/shader_text" tools/shader_text.c -lm
documented README.md table ""
documented docs/algorithm.md graph dot
make_prologues
for module in $MODULES; do
    file=$(file_of "$module")
    case $module in
        lines) make_shaders_header ;;
        *) make_module_file ;;
    esac >"$work/$file.new"
    if [ "${check-}" ]; then
        cmp -s "$work/$file.new" "$file" || die "$file is stale: run ./amalgamate.sh and commit it"
        [ "$(wc -c <"$file")" -lt 1048576 ] || die "$file is over 1 MB"
    else
        cmp -s "$work/$file.new" "$file" 2>/dev/null || cp "$work/$file.new" "$file"
    fi
done
if [ "${check-}" ]; then
    make_all lineao_shaders.h >"$work/lineao_all.h"
    make_all lineao_shaders.h >"$work/again.h"
    cmp -s "$work/lineao_all.h" "$work/again.h" || die "dist/lineao_all.h differs between two runs"
    ! grep -q '^#include "lineao' "$work/lineao_all.h" || die "an include of our own is left in dist/lineao_all.h"
    for pair in "c ${CC:-cc} -std=c99" "c++ ${CXX:-c++} -std=c++11"; do
        language=${pair%% *}
        printf '#define LINEAO_IMPLEMENTATION\n#define LINEAO_GL_IMPLEMENTATION\n#define LINEAO_VK_IMPLEMENTATION\n#include "lineao_all.h"\n' |
            ${pair#* } -Wall -Wextra -Wpedantic -Werror -ffp-contract=off -I"$work" -x "$language" -c - -o "$work/all.o" ||
            die "dist/lineao_all.h does not compile as $language"
        if nm -g --defined-only "$work/all.o" | awk '{print $3}' | grep -v '^lao_' | grep -q .; then
            die "dist/lineao_all.h exports more than lao_ symbols"
        fi
    done
    printf 'the files of shaders are current; dist/lineao_all.h compiles as C99 and C++11\n'
elif [ -f lineao_gl.c ] && [ -f lineao_vk.c ]; then
    mkdir -p dist
    make_all lineao_shaders.h >dist/lineao_all.h
fi
