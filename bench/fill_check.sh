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

# shellcheck source-path=SCRIPTDIR source=peer.sh
. "$here/peer.sh"
opencv() { "$peer_python" -c 'import cv2'; }
peer_need opencv python3-opencv

"$bench" --screen --export-fills "$work" --json >"$work/ours.json"
"$peer_python" "$here/fill_peer.py" "$work" >"$work/peer.json"
"$peer_python" - "$work/ours.json" "$work/peer.json" <<'END'
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
