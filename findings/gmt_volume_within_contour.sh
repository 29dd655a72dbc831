#!/bin/bash
# The volume of a deposit's grid: GMT's grdvolume counts whole cells if it has no contour. With one, which one adds to
# leave out the ground around (-C0, or -C0.1 for what is thicker than 10 cm), it joins the middles of cells, and half a
# cell is lost all along a rim beyond which there is no value: 14 % of a deposit of 20 x 10 cells that is 1 m thick. A
# contour of 0.1 also takes 10 cm off the thickness of all the rest, unless -L0 is given.
# shellcheck source-path=SCRIPTDIR source=debian.bash
source "$(dirname "${BASH_SOURCE[0]}")/debian.bash"

unpack gmt 6.4.0+dfsg-2
gmt() { GMT_SHAREDIR=$usr/share/gmt run gmt "$@"; }

# 24 x 14 cells of 5 m, values in 20 x 10 of them
{ printf 'ncols 24\nnrows 14\nxllcorner 0\nyllcorner 0\ncellsize 5\nNODATA_value -9999\n'
  awk 'BEGIN { for (j = 0; j < 14; j++) for (i = 0; i < 24; i++)
    print (i > 1 && i < 22 && j > 1 && j < 12) ? 1 : -9999 }'
} >deposit.asc
seen=
for contour in "" -C0 -C0.1 "-C0.1 -L0"; do
  # shellcheck disable=SC2086 # none, one or two options
  seen+="${contour:-no contour}: $(gmt grdvolume deposit.asc=ei $contour 2>>gmt.log |
    awk '{ printf "%.0f m2, %.0f m3; ", $2, $3 }')"
done
expected='no contour: 5000 m2, 5000 m3; -C0: 4275 m2, 4275 m3; -C0.1: 4275 m2, 3847 m3; -C0.1 -L0: 4275 m2, 4275 m3; '

echo "software:     GMT $(gmt --version), of Debian 12"
echo "a good guess: 5000 m2, 5000 m3 in each case (200 cells of 25 m2, 1 m thick)"
echo "seen:         $seen"
[[ $seen == "$expected" ]] || { echo "CHANGED: it was $expected" >&2; exit 1; }
