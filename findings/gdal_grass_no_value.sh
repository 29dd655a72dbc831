#!/bin/bash
# GRASS writes `*` into its ASCII grids where a cell has no value (r.out.ascii; the header's "null:" is optional).
# GDAL's driver GRASSASCIIGrid reads such a cell as the height 0, declares no NODATA value, and reports no error.
# A DEM that goes from GRASS to GDAL as text therefore gets pits down to sea level along every border and lake.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"
npm install --silent --no-audit --no-fund gdal3.js@2.8.1 >npm.log 2>&1 || { echo "gdal3.js 2.8.1 cannot be had" >&2; exit 77; }

cat >grass.txt <<'GRID'
north: 4003
south: 4000
east: 7004
west: 7000
rows: 3
cols: 4
105.5 106.5 * 108.5
* 107 108 109
107 108 109 110
GRID

cat >look.js <<'JS'
require('gdal3.js/node')().then(async gdal => {
  const { datasets, errors } = await gdal.open('grass.txt');
  const about = await gdal.gdalinfo(datasets[0], ['-stats']);
  const points = await gdal.gdal_translate(datasets[0], ['-of', 'XYZ'], 'points');
  const heights = Buffer.from(await gdal.getFileBytes(points)).toString().trim().split('\n').map(line => +line.split(' ')[2]);
  console.log(JSON.stringify({ driver: about.driverShortName, errors, nodata: about.bands[0].noDataValue ?? null, heights }));
  process.exit(0);
});
JS
seen=$(node look.js 2>node.log | tail -n 1)
expected='{"driver":"GRASSASCIIGrid","errors":[],"nodata":null,"heights":[105.5,106.5,0,108.5,0,107,108,109,107,108,109,110]}'

echo "software:     GDAL $(grep -ao 'gdal-3\.[0-9.]*[0-9]' node_modules/gdal3.js/dist/package/gdal3WebAssembly.wasm | head -n 1 | cut -c6-), of gdal3.js 2.8.1"
echo "a good guess: the two cells with * are NODATA, or the grid is refused"
echo "seen:         $seen"
[[ $seen == "$expected" ]] || { echo "CHANGED: it was $expected" >&2; exit 1; }
