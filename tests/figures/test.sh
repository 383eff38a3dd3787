#!/bin/sh
# Every sheet of examples/figures is whole: its figure has rows and columns, its arguments are understood and its cameras are
# there; a sheet whose data is absent is left out, and a figure that does not exist is named.
#   test.sh PROGRAM
set -eu
program=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
script=$root/examples/figures/figures.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT INT TERM
unset LINEAO_DATA
die() {
    printf 'figures: %s\n' "$*" >&2
    exit 1
}

# A program that takes the place of lineao: it notes what it is asked for and asks lineao only for the camera, so that
# arguments are parsed and scenes are known but nothing is rendered. Sheets are empty files.
cat >"$work/program" <<TEXT
#!/bin/sh
set -eu
command=\$1
printf '%s\n' "\$*" >>"$work/calls"
shift
for last; do :; done # the output
case \$command in render | vessel | surface) "$program" "\$command" "\$@" --save-camera "$work/camera.json" --help >/dev/null ;; esac
: >"\$last"
TEXT
chmod +x "$work/program"

"$script" "$work/program" "$work/all" >"$work/out" 2>"$work/err" || die "$(cat "$work/err")"
figures=$(sed -n 's/^figure \([a-z0-9_]*\) .*/\1/p' "$root"/examples/figures/*.table)
for name in $figures; do
    case $name in
        koehler8_data | lawonn7_data | lawonn_value)
            [ ! -e "$work/all/$name.png" ] || die "$name: was drawn without data"
            grep -q "$name: LINEAO_DATA" "$work/err" || die "$name: was left out without a word"
            ;;
        *)
            grep -qx "$work/all/$name.png" "$work/out" || die "$name: its path was not printed"
            grep -q "^sheet .*$work/all/$name.png" "$work/calls" || die "$name: has no sheet"
            ;;
    esac
done
[ "$(grep -vc '^sheet' "$work/calls")" -ge 40 ] || die "fewer than 40 panels"
for camera in "$root"/examples/figures/cameras/*.json; do
    grep -q "$camera" "$work/calls" || die "$camera: is used by no figure"
    case $(head -c 1 "$camera") in
        '[') "$program" vessel --nodes 20 --cameras "$camera" --save-camera "$work/camera.json" || die "$camera: cannot be read" ;;
        *) "$program" render --lines 20 --camera "$camera" --save-camera "$work/camera.json" || die "$camera: cannot be read" ;;
    esac
done
if grep "@" "$work/calls"; then die "a place was not filled in"; fi

# And one for real.
FIGURES_SIZE=64x48 "$script" "$program" "$work/real" koehler_backdrop >"$work/out" || die "koehler_backdrop: failed"
[ -s "$work/real/koehler_backdrop.png" ] || die "koehler_backdrop: there is no picture"

if "$script" "$program" "$work/none" figure99 2>"$work/err"; then die "figure99: was taken"; fi
grep -q "figure99: is no figure" "$work/err" || die "figure99: was not named"
if "$script" "$work/nosuch" "$work/none" 2>"$work/err"; then die "a missing program was taken"; fi
printf 'all figures are whole\n'
