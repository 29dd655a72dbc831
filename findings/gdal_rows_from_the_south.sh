#!/bin/bash
# Official XYZ grids may begin in the south (North Rhine-Westphalia's DGM1). GDAL's raster of one has rows that go north, a
# geotransform that says so, and GeoTIFF, AAIGrid and others write it rightly. Its Idrisi driver (RST) writes the rows as
# they come under a header that is north up, its ER Mapper driver (ERS) does so with a header that lies south of the terrain:
# the terrain is mirrored, or mirrored and beside its place, without an error.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"
npm install --silent --no-audit --no-fund gdal3.js@2.8.1 >npm.log 2>&1 || { echo "gdal3.js 2.8.1 cannot be had" >&2; exit 77; }

# 10 x 20 cells of 2 m with the south-western corner at 4000 7000: 100.5 m in the southernmost row, 119.5 m in the northernmost
awk 'BEGIN { for (j = 0; j < 20; j++) for (i = 0; i < 10; i++) print 4001 + 2 * i, 7001 + 2 * j, 100.5 + j }' >rows.xyz

cat >look.js <<'JS'
require('gdal3.js/node')().then(async gdal => {
  const source = (await gdal.open('rows.xyz')).datasets[0];
  for (const format of ['GTiff', 'AAIGrid', 'RST', 'ERS']) {
    const copy = await gdal.gdal_translate(source, ['-of', format], `copy_${format}`);
    const opened = await gdal.open([copy.local]);
    const points = await gdal.gdal_translate(opened.datasets[0], ['-of', 'XYZ'], `points_${format}`);
    const lines = Buffer.from(await gdal.getFileBytes(points)).toString().trim().split('\n').map(line => line.split(' ').map(Number));
    const [, y, z] = lines.reduce((a, b) => b[2] > a[2] ? b : a);
    console.log(format, 'highest cell', z, 'm at y', y);
  }
  process.exit(0);
});
JS
seen=$(node look.js 2>node.log | grep highest)
expected='GTiff highest cell 119.5 m at y 7039
AAIGrid highest cell 119.5 m at y 7039
RST highest cell 119.5 m at y 7001
ERS highest cell 119.5 m at y 6961'

echo "software:     GDAL $(grep -ao 'gdal-3\.[0-9.]*[0-9]' node_modules/gdal3.js/dist/package/gdal3WebAssembly.wasm | head -n 1 | cut -c6-), of gdal3.js 2.8.1"
echo "a good guess: y 7039 in every format"
echo "seen:"
echo "$seen"
[[ $seen == "$expected" ]] || { echo "CHANGED: it was $expected" >&2; exit 1; }
