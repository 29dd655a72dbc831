#!/bin/bash
# A polygon of 40 m x 30 m on a grid of 5 m has its edges on those of cells: 48 cells. Of the four methods of SAGA's
# Grid Statistics for Polygons the one by "cell area" also counts the cells outside that touch an edge: 80. The one by
# "cell area weighted" gives a sum times the cell's area, m3 where the values are metres; under the same name, the sum
# of the others is metres. Shapes to Grid makes 63 cells of the polygon unless told otherwise: one more column in the
# east, one row in the north.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"

# SAGA of Debian 12 with the libraries that it needs, unpacked, not installed
mkdir -p lists/partial debs/partial root && : >status
# shellcheck disable=SC2016 # apt expands these
mirror=$(apt-get indextargets --format '$(ORIGIN) $(REPO_URI)' 'Created-By: Packages' |
  sed -n '/security/d; s/^Debian //p' | head -n 1)
echo "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror bookworm main" >sources.list
apt=(-qq -o Dir::Etc::SourceList="$tmp/sources.list" -o Dir::Etc::SourceParts=/dev/null
     -o Dir::State::Lists="$tmp/lists" -o Dir::State::status="$tmp/status" -o Dir::Cache="$tmp"
     -o Dir::Cache::Archives="$tmp/debs" -o Debug::NoLocking=1)
version=8.5.0+dfsg-2
{ apt-get "${apt[@]}" update && apt-get "${apt[@]}" -d -y --no-install-recommends install saga=$version
} >apt.log 2>&1 || { echo "Debian's saga $version cannot be had" >&2; exit 77; }
for deb in debs/*.deb; do dpkg-deb -x "$deb" root; done
lib=$tmp/root/usr/lib/x86_64-linux-gnu libc=$tmp/root/lib/x86_64-linux-gnu
mkdir tools && ln -s "$lib"/saga/lib{io_grid,io_shapes,io_table,grid_gridding,shapes_grid}.so tools
saga() {
  SAGA_TLB=$tmp/tools "$libc/ld-linux-x86-64.so.2" --library-path "$lib:$libc:$lib/blas:$lib/lapack" \
    "$tmp/root/usr/bin/saga_cmd" --flags=s --cores=1 "$@" >>saga.log 2>&1 || { cat saga.log >&2; exit 1; }
}

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
