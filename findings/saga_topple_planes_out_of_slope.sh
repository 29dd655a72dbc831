#!/bin/bash
# SAGA's WEDGEFAIL marks cells where a plane of a given dip and dip direction makes sliding or toppling possible. Slabs
# topple where their planes dip INTO the slope, by at least 90 degrees less the face's angle plus that of friction. The
# mode "Topple" has this limit, but marks planes that dip OUT of the slope, and none that dip into it: for toppling, the
# dip direction must be turned by 180 degrees first, which its description does not say. "Slide" takes it as it is.
# shellcheck source-path=SCRIPTDIR source=debian.bash
source "$(dirname "${BASH_SOURCE[0]}")/debian.bash"

unpack_saga io_grid ta_slope_stability

# a face of 60 degrees that falls to the east, cells of 5 m, friction 30 degrees
{ printf 'ncols 5\nnrows 5\nxllcorner 0\nyllcorner 0\ncellsize 5\nNODATA_value -9999\n'
  awk 'BEGIN { for (j = 0; j < 5; j++) for (i = 0; i < 5; i++) printf "%.4f\n", 500 - 5 * i * sqrt(3) }'
} >face.asc
saga io_grid 1 -FILE face.asc -GRID face.sgrd
seen=
for mode in 0:slides 1:topples; do
  for side in "90:out of" 270:into; do
    dips=
    for dip in 20 40 70; do
      saga ta_slope_stability 4 -DEM face.sgrd -fC "${side%:*}" -fD $dip -fEmin 30 -fEmax 30 \
        -METHOD ${mode%:*} -F fail.sgrd
      saga io_grid 0 -GRID fail.sgrd -FILE fail.asc -PREC 0
      [[ $(sed -n 9p fail.asc | cut -d ' ' -f 3) != 1 ]] || dips+=" $dip"
    done
    seen+="${mode#*:} if the plane dips ${side#*:} it:${dips:- never}; "
  done
done
expected='slides if the plane dips out of it: 40; slides if the plane dips into it: never; '
expected+='topples if the plane dips out of it: 70; topples if the plane dips into it: never; '

echo "software:     SAGA $version of Debian 12"
echo "a good guess: the face of 60 degrees topples if the plane dips into it: 70"
echo "seen:         $seen"
[[ $seen == "$expected" ]] || { echo "CHANGED: it was $expected" >&2; exit 1; }
