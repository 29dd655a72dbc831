#!/bin/bash
# SAGA's Export Surfer Grid writes a cell without data as the number that its own grid has for it, -9999. The format,
# Surfer's binary grid (DSBB), has one mark for such cells, 1.70141e38, and no place to name another; SAGA writes that
# if its option "Use Surfer's No-Data Value" is set, which it is not. The header still says that the heights are 100 to
# 111: whatever reads the file has pits 10 km deep along the border, which count in a volume.
# shellcheck source-path=SCRIPTDIR source=debian.bash
source "$(dirname "${BASH_SOURCE[0]}")/debian.bash"

unpack_saga io_grid

printf 'ncols 4\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999
100 101 102 103\n104 -9999 106 107\n108 109 110 111\n' >ground.asc
saga io_grid 1 -FILE ground.asc -GRID ground.sgrd
seen=
for mark in default:"" chosen:"-NODATA 1"; do
  # shellcheck disable=SC2086 # none or one option
  saga io_grid 2 -GRID ground.sgrd -FILE ground.grd ${mark#*:}
  # header: DSBB, two short integers, six doubles (the last two of which are the least and the greatest height)
  seen+="${mark%:*}: header $(od -An -t f8 -j 40 -N 16 ground.grd | xargs), "
  seen+="middle $(od -An -t f4 -j 76 -N 4 ground.grd | xargs); "
done
expected='default: header 100 111, middle -9999; chosen: header 100 111, middle 1.70141e+38; '

echo "software:     SAGA $version of Debian 12"
echo "a good guess: 1.70141e+38, the only mark of this format, in both"
echo "seen:         $seen"
[[ $seen == "$expected" ]] || { echo "CHANGED: it was $expected" >&2; exit 1; }
