#!/usr/bin/env bash
# Proves that the comparisons with other programs pass, say why in one line and run nothing, where the peer is missing
# and cannot be installed, or is installed and does not load.
set -euo pipefail
bench=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../bench" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for module in cv2 vtk; do
  echo 'raise ImportError("hidden by the test")' >"$work/$module.py"
done

# expect NAME EXIT WORDS: what it says when apt-get ends like that
expect() {
  local said code=0
  printf '#!/bin/sh\nexit %s\n' "$2" >"$work/apt-get"
  chmod +x "$work/apt-get"
  said=$(env PATH="$work:$PATH" PYTHONPATH="$work" TMPDIR="$work" "$bench/$1" /bin/false 2>&1) || code=$?
  if [ "$code" != 0 ] || [ "$said" != "${1%.sh}: skipped: $3" ]; then
    echo "$1, apt-get ends with $2: $code, '$said'; expected 0 and '$3'" >&2
    exit 1
  fi
}

expect fill_check.sh 1 "without python3-opencv, which could not be installed, there is no peer"
expect peer_check.sh 1 "without python3-vtk9 xvfb, which could not be installed, there is no peer"
if [ "$(id -u)" = 0 ]; then # nobody else installs
  expect fill_check.sh 0 "the peer does not work: ImportError: hidden by the test"
  DISPLAY=:0 expect peer_check.sh 0 "the peer does not work: ImportError: hidden by the test"
fi
[ -z "$(find "$work" -mindepth 1 -name 'tmp.*')" ] || { echo "a folder was left" >&2 && exit 1; }
