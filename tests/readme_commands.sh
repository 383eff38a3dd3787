#!/usr/bin/env bash
# Proves that every command which the README shows in a ```sh block works as shown.
# Each block is one script, so a cd holds to its end; lines of tests/readme_skip.txt are left out. The blocks run one
# after another in a scratch folder whose entries are links to the repository's, so that files they make stay there.
set -u
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
readme=$root/README.md
if [ ! -e "$readme" ]; then
  echo "README.md is missing"
  exit 1
fi
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/lineao"
for entry in "$root"/* "$root"/.ci; do
  case ${entry##*/} in build | demo | dist) continue ;; esac
  ln -s "$entry" "$scratch/lineao/"
done

awk -v skip="$root/tests/readme_skip.txt" -v out="$scratch" '
  BEGIN { while ((getline line < skip) > 0) if (line !~ /^#/) skipped[line] = 1 }
  /^```/ { inside = !inside && $0 ~ /^```sh[ \t]*$/
           if (inside) { file = sprintf("%s/block%03d.sh", out, ++blocks)
                         printf "# README.md:%d\n", NR > file } 
           next }
  inside { print (($0 in skipped) ? ":" : $0) > file }
' "$readme"

failed=0 blocks=0
for block in "$scratch"/block*.sh; do
  [ -e "$block" ] || continue
  blocks=$((blocks + 1))
  echo "== $(head -n 1 "$block")"
  if ! (cd "$scratch/lineao" && bash -euvo pipefail "$block" </dev/null 2>&1); then
    echo "FAILED: $(head -n 1 "$block"), the last command shown above"
    failed=$((failed + 1))
  fi
done
echo "$blocks blocks, $failed failed"
[ $failed = 0 ] && [ $blocks -gt 0 ]
