#!/bin/sh
# The files of the deck from the public rasters: prepare.sh DATA CASE
# DATA holds Frankslide_topography.asc and Frankslide_pile.asc; CASE is the new folder of the deck.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
slope=${SLOPE_TOOLS:-$here/../../tools}/slope
[ $# = 2 ] || { sed -n '2,3s/^# //p' "$0"; exit 2; }
mkdir -p "$2"
data=$(cd "$1" && pwd)
cd "$2"
cp "$here/in.frank" .
/usr/bin/python3 "$here/prepare.py" "$data" -o sum.asc
"$slope" terrain sum.asc -o before.asc
"$slope" terrain "$data/Frankslide_topography.asc" -o after.asc
"$slope" release before.asc --scar after.asc -o release
rm sum.asc
