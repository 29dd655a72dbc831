#!/bin/bash
# An XYZ grid may name its columns, and GDAL finds x, y, z by the names, in any order: north,east,height is read rightly.
# With Northing,Easting,Elevation, the head of a surveyor's list, it finds one name of the three, takes the columns by their
# places, with a warning that a program's log may not show, and status 0: the terrain is its mirror image, east for north.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"
npm install --silent --no-audit --no-fund gdal3.js@2.8.1 >npm.log 2>&1 || { echo "gdal3.js 2.8.1 cannot be had" >&2; exit 77; }

# 4 points to the east, 3 to the north, northing fastest; the numbers of both files are the same, the heads are not
for head in north,east,height Northing,Easting,Elevation; do
  { echo "$head"; awk 'BEGIN { OFS = ","; for (e = 0; e < 4; e++) for (n = 0; n < 3; n++) print 7000 + 10 * n, 4000 + 10 * e, 100 + n + e / 10 }'
  } >"${head%%,*}.csv"
done

cat >look.js <<'JS'
require('gdal3.js/node')().then(async gdal => {
  for (const name of ['north', 'Northing']) {
    const about = await gdal.gdalinfo((await gdal.open(`${name}.csv`)).datasets[0]);
    console.log('grid', name, about.driverShortName, about.size.join(' x '), 'from', about.geoTransform[0], about.geoTransform[3]);
  }
  process.exit(0);
});
JS
seen=$(node look.js 2>node.log | grep '^grid')
expected='grid north XYZ 4 x 3 from 3995 7025
grid Northing XYZ 3 x 4 from 6995 3995'

echo "software:     GDAL $(grep -ao 'gdal-3\.[0-9.]*[0-9]' node_modules/gdal3.js/dist/package/gdal3WebAssembly.wasm | head -n 1 | cut -c6-), of gdal3.js 2.8.1"
echo "a good guess: 4 x 3 cells from 3995 7025 for both, or no grid at all"
echo "seen:"
echo "$seen"
grep -o 'Could not find.*' node.log | head -n 1 || true
[[ $seen == "$expected" ]] || { echo "CHANGED: it was $expected" >&2; exit 1; }
