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

skip() {
  echo "near_check: skipped: $1"
  exit 0
}

have() { /usr/bin/python3 -c 'import scipy.spatial' 2>/dev/null; }

install() {
  local apt=(env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300 -o Dpkg::Use-Pty=0)
  [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null || return 1
  { "${apt[@]}" update && "${apt[@]}" install -y --no-install-recommends python3-scipy; } >"$work/apt" 2>&1 </dev/null
}

[ -x /usr/bin/python3 ] || skip "there is no /usr/bin/python3"
if ! have; then
  install || skip "the package python3-scipy is missing and could not be installed"
  have || skip "SciPy does not load: $(/usr/bin/python3 -c 'import scipy.spatial' 2>&1 | tail -n 1)"
fi

"$bench" --steps 1 --export "$work" --least 50 >"$work/ours.json"
reach=$(/usr/bin/python3 -c 'import json,sys; print(json.load(open(sys.argv[1]))["reach_ms"])' "$work/ours.json")
/usr/bin/python3 "$here/near_peer.py" "$work" "$reach" >"$work/peer.json"
/usr/bin/python3 - "$work/ours.json" "$work/peer.json" <<'END'
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
