#!/usr/bin/env bash
# Proves that each public header compiles alone and twice, as C99, C11, C++11 and C++20, without a warning, that two
# translation units of one program can include it, that each implementation links without the others, and that the
# executors compile by hand.
set -u
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch" || exit 1

strict=(-Wall -Wextra -Wpedantic -Wconversion -Werror -I"$root")

# clang's -Weverything, minus what contradicts our rules:
everything=(-Weverything
  -Wno-unknown-warning-option       # newer names below, older compilers
  -Wno-padded                       # layout of public structs is for reading; uniform blocks have offset asserts
  -Wno-declaration-after-statement  # we write C99, not C89
  -Wno-unused-macros                # constants are for hosts
  -Wno-float-equal                  # exact results are the point
  -Wno-covered-switch-default       # an enum from outside can hold any number
  -Wno-switch-default
  -Wno-disabled-macro-expansion     # libc's own macros
  -Wno-reserved-identifier          # private names are lao__name
  -Wno-reserved-macro-identifier
  -Wno-unsafe-buffer-usage          # pointers are C's arrays
  -Wno-c++98-compat -Wno-c++98-compat-pedantic -Wno-old-style-cast -Wno-zero-as-null-pointer-constant
  -Wno-pre-c++17-compat -Wno-pre-c11-compat -Wno-pre-c2x-compat)

headers=(lineao.h sdfvessel.h vesselsurface.h flow4d.h)
compilers=()
for compiler in gcc clang; do
  if command -v $compiler >/dev/null; then compilers+=("$compiler"); fi
done
if [ ${#compilers[@]} = 0 ]; then
  echo "there is neither gcc nor clang"
  exit 1
fi

failed=0 done=0
try() { # try NAME COMMAND...
  local name=$1
  shift
  done=$((done + 1))
  if ! "$@" >log 2>&1; then
    failed=$((failed + 1))
    echo "FAILED $name"
    echo "  $*"
    head -n 20 log
  fi
}

implementation() { # every header's implementation, on standard output
  local header macro
  for header in "${headers[@]}"; do
    macro=${header%.h}
    printf '#define %s_IMPLEMENTATION\n#include "%s"\n' "${macro^^}" "$header"
  done
}

for header in "${headers[@]}"; do
  printf '#include "%s"\n#include "%s"\nint one_declaration;\n' "$header" "$header" >"${header%.h}_alone.c"
  macro=${header%.h}_IMPLEMENTATION
  printf '#include "%s"\n#define %s\n#include "%s"\nint main(void) { return 0; }\n' "$header" "${macro^^}" "$header" \
    >"${header%.h}_only.c"
done
implementation >first.c
printf '#include "%s"\n' "${headers[@]}" >second.c
echo 'const char *second(void); const char *second(void) { return lao_result_text(LAO_OK); }' >>second.c
implementation >third.c # includes after an implementation declare nothing twice
printf '#include "%s"\n' "${headers[@]}" >>third.c
cat >>first.c <<'C'
extern const char *second(void);
int main(void) { return second() == lao_result_text(LAO_OK) ? 0 : 1; }
C

mkdir copied
cp "$root"/lineao{.h,_shaders.h,_gl.c,_vk.c} copied/

for compiler in "${compilers[@]}"; do
  for standard in c99 c11 c++11 c++20; do
    language=c
    if [[ $standard == c++* ]]; then language=c++; fi
    as=("$compiler" -x "$language" "-std=$standard" "${strict[@]}")
    declare_only=("${as[@]}" -fsyntax-only)
    if [ "$compiler" = clang ]; then
      declare_only+=("${everything[@]}" -Wno-missing-variable-declarations)
    fi
    for header in "${headers[@]}"; do
      try "$compiler $standard $header" "${declare_only[@]}" "${header%.h}_alone.c"
    done
    case $standard in c99 | c++11)
      try "$compiler $standard implementation, then headers" "${as[@]}" -fsyntax-only third.c
      try "$compiler $standard two units" "${as[@]}" first.c second.c -x none -lm -o program
      try "$compiler $standard two units, run" ./program
      for header in "${headers[@]}"; do
        try "$compiler $standard implementation of $header only" "${as[@]}" "${header%.h}_only.c" -x none -lm -o program
      done
      ;;
    esac
  done
  for executor in lineao_gl lineao_vk; do
    try "$compiler $executor.c" "$compiler" -std=c99 "${strict[@]}" -c "$root/$executor.c" -o "$executor.o"
    try "$compiler $executor.c of a host that copies lines alone" \
      "$compiler" -std=c99 "${strict[@]:0:5}" -c "copied/$executor.c" -o "$executor.o"
  done
done

echo "$done compilations and runs (${compilers[*]}; ${headers[*]}), $failed failed"
[ $failed = 0 ]
