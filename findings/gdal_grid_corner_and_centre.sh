#!/bin/bash
# The header of an ESRI ASCII grid has xllcorner or xllcenter, and yllcorner or yllcenter. GDAL takes both as corners or both
# as centres; a grid with one of each it takes without a word for one that names no place: its corner, the upper left one, is at
# 0 0, whatever the two numbers are.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"
npm install --silent --no-audit --no-fund gdal3.js@2.8.1 >npm.log 2>&1 || { echo "gdal3.js 2.8.1 cannot be had" >&2; exit 77; }

for x in corner center; do
  for y in corner center; do
    printf 'ncols 4\nnrows 3\nxll%s 4000\nyll%s 7000\ncellsize 10\n100 101 102 103\n104 105 106 107\n108 109 110 111\n' $x $y >${x}_$y.asc
  done
done

cat >look.js <<'JS'
require('gdal3.js/node')().then(async gdal => {
  for (const name of ['corner_corner', 'center_center', 'corner_center', 'center_corner']) {
    const { datasets, errors } = await gdal.open(`${name}.asc`);
    const about = await gdal.gdalinfo(datasets[0]);
    console.log('grid', name, 'at', JSON.stringify(about.geoTransform ?? null), errors.length, 'errors');
  }
  process.exit(0);
});
JS
seen=$(node look.js 2>node.log | grep '^grid')
expected='grid corner_corner at [4000,10,0,7030,0,-10] 0 errors
grid center_center at [3995,10,0,7025,0,-10] 0 errors
grid corner_center at [0,10,0,0,0,-10] 0 errors
grid center_corner at [0,10,0,0,0,-10] 0 errors'

echo "software:     GDAL $(grep -ao 'gdal-3\.[0-9.]*[0-9]' node_modules/gdal3.js/dist/package/gdal3WebAssembly.wasm | head -n 1 | cut -c6-), of gdal3.js 2.8.1"
echo "a good guess: each axis by its own word, or an error"
echo "seen:"
echo "$seen"
[[ $seen == "$expected" ]] || { echo "CHANGED: it was $expected" >&2; exit 1; }
