#!/usr/bin/env bash
# Does pull-push fill a void in less time than OpenCV's inpainting and inverse distances, in one
# session, with no greater error than the better of them by a half?
#   bench/fill_check.sh path/to/lineao_bench
# One thread each; the error is against what the void was cut out of. Without python3-opencv, which
# is installed where that is allowed, it says so and passes.
set -euo pipefail
bench=${1:?usage: fill_check.sh path/to/lineao_bench}
here=$(dirname "$(readlink -f "$0")")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

skip() {
  echo "fill_check: skipped: $1"
  exit 0
}

have() { /usr/bin/python3 -c 'import cv2' 2>/dev/null; }

install() {
  local apt=(env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0)
  [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null || return 1
  { "${apt[@]}" update && "${apt[@]}" install -y --no-install-recommends python3-opencv; } >"$work/apt" 2>&1 </dev/null
}

[ -x /usr/bin/python3 ] || skip "there is no /usr/bin/python3"
if ! have; then
  install || skip "the package python3-opencv is missing and could not be installed"
  have || skip "OpenCV does not load: $(/usr/bin/python3 -c 'import cv2' 2>&1 | tail -n 1)"
fi

"$bench" --screen --export-fills "$work" --json >"$work/ours.json"
/usr/bin/python3 "$here/fill_peer.py" "$work" >"$work/peer.json"
/usr/bin/python3 - "$work/ours.json" "$work/peer.json" <<'END'
import json
import sys
ours, peer = (json.load(open(name)) for name in sys.argv[1:3])
failed = False
for fill in ours["fills"]:
    size, ms, error = fill["size"], fill["pull_push_ms"], fill["pull_push_error"]
    others = [("inverse distances", fill["distances_ms"], fill["distances_error"])]
    others += [(f"{peer['program']} {row['method']}", 1000 * row["seconds"], row["error"]) for row in peer["rows"] if row["size"] == size]
    print(f"{size}x{size}, {100 * fill['covered']:.0f} % covered: pull-push {ms:.2f} ms, off by {error:.2f} (root mean square)")
    for name, other, off in others:
        print(f"  {name}: {other:.1f} ms, {other / ms:.0f} times as long; off by {off:.2f}, {off / error:.2f} times as far")
        failed |= other < ms
    failed |= error > 1.5 * min(off for _, _, off in others)
sys.exit("fill_check: NOT the least time, or an error too great" if failed else 0)
END
