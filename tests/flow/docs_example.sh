#!/usr/bin/env bash
# Proves that the program in docs/flow4d.md compiles as it stands, without a warning, and draws lines and a surface.
#   docs_example.sh path/to/cc
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
awk '/^```c$/ { on = 1; next } /^```$/ { on = 0 } on' "$root/docs/flow4d.md" >"$scratch/flow.c"
"${1:?usage: docs_example.sh path/to/cc}" -std=c99 -O2 -ffp-contract=off -Wall -Wextra -Wpedantic -Wconversion -Wshadow \
  -Werror -I"$root" "$scratch/flow.c" -lm -o "$scratch/flow"
"$scratch/flow" | tee "$scratch/out"
grep -Eq '^2000 lines, [1-9][0-9]{4,} points; [1-9][0-9]+ triangles$' "$scratch/out"
