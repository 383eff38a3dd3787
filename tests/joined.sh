#!/usr/bin/env bash
# Proves that amalgamate.sh --check refuses a header of the root that was edited by hand, a part that was edited without
# joining, and a part that is not in the list, and that it names the place to edit.
set -u
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
failed=0

fresh() { rm -rf "$scratch/copy" && mkdir "$scratch/copy" && cp -r "$root"/{amalgamate.sh,parts,*.h} "$scratch/copy"; }
# says WHAT TEXT: the check of the copy fails and says TEXT
says() {
  if "$scratch/copy/amalgamate.sh" --check >"$scratch/log" 2>&1 || ! grep -qF -- "$2" "$scratch/log"; then
    failed=1
    echo "FAILED $1: expected \"$2\", the check said:"
    cat "$scratch/log"
  fi
  fresh
}

fresh
count=0
for folder in "$root"/parts/*/; do
  name=$(basename "$folder")
  count=$((count + 1))
  if ! { head -n 1 "$root/$name.h"; } | grep -qF "parts/$name/"; then
    failed=1
    echo "FAILED $name.h does not say that it is generated from parts/$name/"
  fi
  echo '/* by hand */' >>"$scratch/copy/$name.h"
  says "$name.h edited by hand" "edit parts/$name/, not $name.h, and run ./amalgamate.sh"
  echo '/* not joined */' >>"$scratch/copy/parts/$name/interface.h"
  says "a part of $name.h not joined" "edit parts/$name/, not $name.h, and run ./amalgamate.sh"
  echo '/* not listed */' >"$scratch/copy/parts/$name/unlisted.h"
  says "a part of $name.h not listed" "what lies in parts/$name/: mend parts_of in amalgamate.sh"
done
says "an untouched copy (without tools/)" "tools/shader_text.c" # the joined headers were current: it came as far as that
[ $count -gt 0 ] || failed=1
echo "$count headers"
[ $failed = 0 ]
