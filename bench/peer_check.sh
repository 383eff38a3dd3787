#!/usr/bin/env bash
# How many times as fast as VTK 9.1's tubes with vtkSSAOPass is lineao on the same lines, in one run, and
# does it stay below 500 MB?
#   bench/peer_check.sh path/to/lineao_bench
# Both draw 30000 lines of 100 points at 1706x1834. PEER_LINES, PEER_VIEW (half the size, WxH) and
# PEER_FRAMES (VTK's) change that. Times depend on the machine: the target, 12 times, is told, met or
# missed; it fails for memory, and for time where PEER_LEAST says how many times are wanted. Takes several
# minutes and 5 GB, VTK's. Without python3-vtk9 and xvfb, which are installed where that is allowed, it
# says so and passes.
set -euo pipefail
bench=${1:?usage: peer_check.sh path/to/lineao_bench}
here=$(dirname "$(readlink -f "$0")")
lines=${PEER_LINES:-30000} view=${PEER_VIEW:-853x917} frames=${PEER_FRAMES:-3} least=${PEER_LEAST:-0}
size=$((${view%x*} * 2))x$((${view#*x} * 2))
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# shellcheck source-path=SCRIPTDIR source=peer.sh
. "$here/peer.sh"
vtk() {
  [ -n "${DISPLAY-}" ] || command -v Xvfb || { echo "there is neither a display nor Xvfb" && return 1; }
  "$peer_python" -c 'import vtk'
}
peer_need vtk python3-vtk9 xvfb

export LIBGL_ALWAYS_SOFTWARE=1
"$bench" --lines "$lines" --size "$view@2" --export-lines "$work/lines"
"$bench" --lines "$lines" --size "$view@2" --presets default --json >"$work/lineao.json"
"$peer_python" "$here/vtk_peer.py" "$work/lines" --size "$size" --frames "$frames" >"$work/vtk.json"
"$peer_python" - "$work/lineao.json" "$work/vtk.json" "$least" <<'END'
import json
import sys
with open(sys.argv[1]) as file:
    scene = json.load(file)["scenes"][0]
with open(sys.argv[2]) as file:
    peer = json.load(file)
least, failed = float(sys.argv[3]), False
print(f"{scene['lines']} lines of 100 points, {scene['width']}x{scene['height']}, median (least) of a frame")
print(f"{peer['program']}, tubes and vtkSSAOPass: {peer['median_ms']:.0f} ({peer['min_ms']:.0f}) ms, {peer['peak_mb']:.0f} MB")
for name, side in scene["backends"].items():
    frame = side["presets"]["default"]["frame_ms"]
    ratio = peer["median_ms"] / frame["median"]
    wrong = [f"NOT {least:g} times"] if ratio < least else []
    wrong += ["NOT within 500 MB"] if side["peak_mb"] > 500 else []
    failed |= bool(wrong)
    print(f"lineao {name}: {frame['median']:.0f} ({frame['min']:.0f}) ms, {side['peak_mb']:.0f} MB; VTK takes {ratio:.1f} "
          f"times as long ({peer['min_ms'] / frame['min']:.1f}); the target of 12 is {'met' if ratio >= 12 else 'MISSED'}"
          f"{': ' if wrong else ''}{', '.join(wrong)}")
sys.exit(failed)
END
