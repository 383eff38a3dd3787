#!/usr/bin/env bash
# Proves that an installed lineao serves a host by find_package, by pkg-config, and as plain files.
# usage: test.sh BUILD_DIR [CC]
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=${1:?usage: test.sh BUILD_DIR [CC]}
cc=${2:-cc}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
prefix=$scratch/prefix
strict=(-std=c99 -Wall -Wextra -Wpedantic -Werror)

cmake --install "$build" --prefix "$prefix" >"$scratch/install.log" || { cat "$scratch/install.log"; exit 1; }
if grep -rlF "$build" "$prefix/include" "$prefix/lib"*/{cmake,pkgconfig,*/cmake,*/pkgconfig} 2>/dev/null; then
  echo "the files above, as installed, name the build directory"
  exit 1
fi

echo "-- find_package"
cmake -S "$here" -B "$scratch/build" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_COMPILER="$cc"
cmake --build "$scratch/build"
by_cmake=$("$scratch/build/consumer")

echo "-- pkg-config"
PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name lineao.pc)")
export PKG_CONFIG_PATH
read -ra cflags < <(pkg-config --cflags lineao)
read -ra libs < <(pkg-config --libs lineao)
"$cc" "${strict[@]}" "${cflags[@]}" "$here/main.c" "${libs[@]}" -o "$scratch/by_pkgconfig"
by_pkgconfig=$("$scratch/by_pkgconfig")

echo "-- plain files"
printf '#define LINEAO_IMPLEMENTATION\n#include <lineao.h>\n' >"$scratch/lineao.c"
"$cc" "${strict[@]}" "${cflags[@]}" "$here/main.c" "$scratch/lineao.c" -lm -o "$scratch/by_hand"
by_hand=$("$scratch/by_hand")
sources=$(pkg-config --variable=sourcedir lineao)
for file in lineao_gl lineao_vk; do
  "$cc" "${strict[@]}" "${cflags[@]}" -c "$sources/$file.c" -o "$scratch/$file.o"
done

version=$(pkg-config --modversion lineao)
for said in "$by_cmake" "$by_pkgconfig" "$by_hand"; do
  echo "$said"
  [[ $said == "lineao $version: "* ]] || { echo "lineao.pc says version $version"; exit 1; }
done
