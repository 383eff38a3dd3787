#!/usr/bin/env bash
# Are the near-wall distances those of SciPy's cKDTree, in no more time?
#   tests/surface/near_check.sh path/to/bench_surface_near
# 50,000 vertices, 1 million points, one time of the beat, distances to points (the tree knows no
# segments), processor time of one thread. Without python3-scipy, which is installed where that is
# allowed, it says so and passes.
set -euo pipefail
bench=${1:?usage: near_check.sh path/to/bench_surface_near}
here=$(dirname "$(readlink -f "$0")")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# shellcheck source-path=SCRIPTDIR source=../../bench/peer.sh
. "$here/../../bench/peer.sh"
scipy() { "$peer_python" -c 'import scipy.spatial'; }
peer_need scipy python3-scipy

"$bench" --steps 1 --export "$work" --least 50 >"$work/ours.json"
reach=$("$peer_python" -c 'import json,sys; print(json.load(open(sys.argv[1]))["reach_ms"])' "$work/ours.json")
"$peer_python" "$here/near_peer.py" "$work" "$reach" >"$work/peer.json"
"$peer_python" - "$work/ours.json" "$work/peer.json" <<'END'
import json
import sys
ours, peer = (json.load(open(name)) for name in sys.argv[1:3])
mine = ours["step_points_ms"]
ratio = 1000 * peer["seconds"] / mine
print(f"{ours['vertices']} vertices, {ours['points']} points, {peer['lit']} lit")
print(f"brute force {ours['brute_ms']:.0f} ms, lineao {ours['step_ms']:.0f} ms to segments: {ours['ratio']:.0f} times as fast")
print(f"{peer['program']} cKDTree {1000 * peer['seconds']:.0f} ms, lineao {mine:.0f} ms to points: {ratio:.2f} times as fast; "
      f"greatest difference {peer['difference']:.1e} mm")
good = peer["difference"] < 1e-5 and ratio >= 1
sys.exit(0 if good else "near_check: NOT the same distances in no more time")
END
