#!/bin/bash
# A polygon of 40 m x 30 m on a grid of 5 m has its edges on those of cells: 48 cells. Of the four methods of SAGA's
# Grid Statistics for Polygons the one by "cell area" also counts the cells outside that touch an edge: 80. The one by
# "cell area weighted" gives a sum times the cell's area, m3 where the values are metres; under the same name, the sum
# of the others is metres. Shapes to Grid makes 63 cells of the polygon unless told otherwise: one more column in the
# east, one row in the north.
# shellcheck source-path=SCRIPTDIR source=debian.bash
source "$(dirname "${BASH_SOURCE[0]}")/debian.bash"

unpack_saga io_grid io_shapes io_table grid_gridding shapes_grid

{ printf 'ncols 20\nnrows 15\nxllcorner 0\nyllcorner 0\ncellsize 5\nNODATA_value -9999\n'
  seq 300 | sed 's/.*/1/'
} >ones.asc
echo 'POLYGON((20 20, 20 50, 60 50, 60 20, 20 20))' >polygon.txt
saga io_grid 1 -FILE ones.asc -GRID ones.sgrd
saga io_shapes 19 -FILE polygon.txt -SHAPES polygon.shp
seen=
for method in 0 1 2 3; do
  saga shapes_grid 2 -GRIDS ones.sgrd -POLYGONS polygon.shp -METHOD $method -RESULT sums.shp
  saga io_table 0 -TABLE sums.dbf -SEPARATOR 2 -FILENAME sums.csv
  seen+=$(awk -F, -v m=$method 'NR == 2 { printf "method %s: %d cells, sum %g; ", m, $2, $6 }' sums.csv)
done
saga grid_gridding 0 -INPUT polygon.shp -OUTPUT 0 -TARGET_DEFINITION 1 -TARGET_TEMPLATE ones.sgrd -GRID made.sgrd
saga io_grid 5 -GRIDS made.sgrd -FILENAME made.xyz
seen+="grid: $(($(wc -l <made.xyz) - 1)) cells"
expected='method 0: 48 cells, sum 48; method 1: 48 cells, sum 48; method 2: 80 cells, sum 80; '
expected+='method 3: 48 cells, sum 1200; grid: 63 cells'

echo "software:     SAGA $version of Debian 12"
echo "a good guess: 48 cells in each, and the same sum, of 48 values of 1"
echo "seen:         $seen"
[[ $seen == "$expected" ]] || { echo "CHANGED: it was $expected" >&2; exit 1; }
