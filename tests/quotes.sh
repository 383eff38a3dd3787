#!/usr/bin/env bash
# Proves that the pages of docs/ quote the source as it is. Before a block of code a page says where it is from,
#   <!-- quote FILE NAME -->
# and there the lines stand between comments "quote NAME" and "quote end".
#   tests/quotes.sh           compares
#   tests/quotes.sh --write   puts the source's lines into the pages
set -eu
cd "$(dirname "${BASH_SOURCE[0]}")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
quotes=0 stale=0
for page in docs/*.md; do
  grep -q '^<!-- quote ' "$page" || continue
  awk '
    function quote(file, name,    line, inside, found, least, count, i, lines, indent) {
      least = 99
      while ((getline line < file) > 0) {
        if (line ~ ("quote " name " \\*/")) { inside = found = 1; continue }
        if (line ~ /quote end \*\//) inside = 0
        if (!inside) continue
        lines[count++] = line
        if (line ~ /[^ ]/ && match(line, /^ */) && RLENGTH < least) least = RLENGTH
      }
      close(file)
      if (!found || !count) { print FILENAME ": " file " has no quote " name > "/dev/stderr"; exit 1 }
      for (i = 0; i < count; i++) print substr(lines[i], least + 1)
    }
    /^<!-- quote / { print; file = $3; name = $4; next }
    file && /^```/ && !inside { print; inside = 1; quote(file, name); next }
    inside && /^```/ { inside = 0; file = "" }
    !inside { print }
  ' "$page" > "$work/page"
  quotes=$((quotes + $(grep -c '^<!-- quote ' "$page")))
  cmp -s "$page" "$work/page" && continue
  if [ "${1-}" = --write ]; then
    cp "$work/page" "$page"
  else
    echo "$page does not quote the source as it is; run tests/quotes.sh --write"
    diff "$page" "$work/page" || true
    stale=1
  fi
done
echo "$quotes quotes"
[ $stale = 0 ] && [ "$quotes" -gt 0 ]
