#!/bin/sh
# The files of the deck from the public rasters: prepare.sh DATA CASE
# DATA holds pre_runout_DEM.asc, landslide_depth.asc and DEM_of_Difference.asc; CASE is the new folder of the deck.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
slope=${SLOPE_TOOLS:-$here/../../tools}/slope
[ $# = 2 ] || { sed -n '2,3s/^# //p' "$0"; exit 2; }
mkdir -p "$2"
data=$(cd "$1" && pwd)
cd "$2"
cp "$here/in.s1000" .
/usr/bin/python3 "$here/prepare.py" "$data" -o gain.asc
"$slope" terrain gain.asc -o deposit.asc     # in the local metres of before.asc, as it has the same edges
"$slope" terrain "$data/pre_runout_DEM.asc" -o before.asc
"$slope" release before.asc --scar "$data/landslide_depth.asc" --scar-is change -o release
rm gain.asc
