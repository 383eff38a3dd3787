#!/bin/sh
# Renders the papers' figures, one sheet of captioned panels each.
#   figures.sh PROGRAM FOLDER [NAME...]    with the lineao program PROGRAM into FOLDER/NAME.png; no NAME: all of them
# Prints the path of each sheet. Rows and columns of data made by others are drawn when LINEAO_DATA names their folder;
# FIGURES_SIZE ("480x360") is a size of panels instead of a table's.
#
# The figures stand in the tables beside this script, whose columns are separated by '|':
#   figure NAME | size of a panel | pictures in a row (0: one for each column) | title | note
#   row    ARGUMENTS | caption     what is drawn: @CAMERAS, @TREES and @DATA stand for folders; rows and columns with @DATA want LINEAO_DATA
#   column ARGUMENTS | caption     how it is drawn
# A panel is `lineao ROW COLUMN`, its command `render` unless the row begins with another one.
set -eu
LC_ALL=C
export LC_ALL
here=$(cd "$(dirname "$0")" && pwd)
die() {
    printf 'figures.sh: %s\n' "$*" >&2
    exit 1
}
[ $# -ge 2 ] || die "usage: figures.sh PROGRAM FOLDER [NAME...]"
program=$1
folder=$2
shift 2
command -v "$program" >/dev/null || die "$program: is no program; give the path of lineao"
mkdir -p "$folder"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM

trim() {
    printf '%s' "$1" | sed 's/^[[:space:]]*//; s/[[:space:]]*$//'
}

# Is the line about data that is not there?
absent() {
    case $1 in
        *@DATA*) [ -z "${LINEAO_DATA-}" ] || [ ! -e "$LINEAO_DATA/$(printf '%s' "$1" | sed 's/.*@DATA\/\([^ ]*\).*/\1/')" ] ;;
        *) return 1 ;;
    esac
}

arguments() {
    printf '%s' "$1" | sed "s|@DATA|${LINEAO_DATA-}|g; s|@CAMERAS|$here/cameras|g; s|@TREES|$here/trees|g"
}

# What was collected of one figure becomes a sheet: files rows and columns hold "ARGUMENTS|caption" lines.
finish() {
    [ -n "$name" ] || return 0
    if [ ! -s "$work/columns" ] || [ ! -s "$work/rows" ]; then
        printf 'figures.sh: %s: LINEAO_DATA does not hold its data; left out\n' "$name" >&2
        return 0
    fi
    many=$(wc -l <"$work/rows")
    in_row=$per_row
    [ "$in_row" -gt 0 ] || in_row=$(wc -l <"$work/columns")
    panel=0
    set --
    while IFS='|' read -r row row_caption; do
        while IFS='|' read -r column caption; do
            panel=$((panel + 1))
            file=$work/$panel.png
            [ "$many" -eq 1 ] || caption="$row_caption: $caption"
            case $row in
                [a-z]*) ;;
                *) row="render $row" ;;
            esac
            # shellcheck disable=SC2046 # arguments are split into words on purpose
            "$program" $(arguments "$row $column") --size "$size" -o "$file" </dev/null
            set -- "$@" "$caption=$file"
        done <"$work/columns"
    done <"$work/rows"
    "$program" sheet "$@" --columns "$in_row" --title "$title" --note "$note" -o "$folder/$name.png"
    printf '%s\n' "$folder/$name.png"
}

# Is the figure asked for?
wanted() {
    [ -n "$names" ] || return 0
    case " $names " in *" $1 "*) return 0 ;; esac
    return 1
}

names=$*
for asked in "$@"; do
    grep -q "^figure $asked |" "$here"/*.table || die "$asked: is no figure of $here"
done
name=
cat "$here"/*.table >"$work/table"
while IFS='|' read -r first second third fourth fifth; do
    rest=$(trim "${first#* }")
    case $first in
        'figure '*)
            finish
            name=
            wanted "$rest" || continue
            name=$rest
            size=${FIGURES_SIZE:-$(trim "$second")}
            per_row=$(trim "$third")
            title=$(trim "$fourth")
            note=$(trim "$fifth")
            : >"$work/rows"
            : >"$work/columns"
            ;;
        'row '* | 'column '*)
            [ -n "$name" ] || continue
            if absent "$first"; then continue; fi
            printf '%s|%s\n' "$rest" "$(trim "$second")" >>"$work/${first%% *}s"
            ;;
    esac
done <"$work/table"
finish
