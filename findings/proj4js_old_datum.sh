#!/bin/bash
# The .prj of a shapefile in Japan's old datum names "D_Tokyo" and, as ESRI writes it, no parameters of the datum. PROJ knows
# the datum by its name and moves coordinates by some 450 m; proj4js takes the text as well, finds no parameters, and gives
# the coordinates back as they were. Release areas on old maps, of the 2000s and before, land in the next valley.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"
npm install --silent --no-audit --no-fund proj4@2.22.0 gdal3.js@2.8.1 >npm.log 2>&1 || { echo "proj4 2.22.0 or gdal3.js 2.8.1 cannot be had" >&2; exit 77; }

cat >tokyo.prj <<'PRJ'
GEOGCS["GCS_Tokyo",DATUM["D_Tokyo",SPHEROID["Bessel_1841",6377397.155,299.1528128]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]]
PRJ

cat >look.js <<'JS'
const proj4 = require('proj4');
const prj = require('fs').readFileSync('tokyo.prj', 'utf8').trim();
require('gdal3.js/node')().then(async gdal => {
  const metres = ([x, y]) => Math.round(Math.hypot((x - 140) * 111320 * Math.cos(37 * Math.PI / 180), (y - 37) * 110990));
  const [by_proj] = await gdal.gdaltransform([[140, 37]], ['-s_srs', prj, '-t_srs', 'EPSG:4326', '-output_xy']);
  console.log('moved: PROJ', metres(by_proj), 'm, proj4js', metres(proj4(prj, 'EPSG:4326', [140, 37])), 'm');
  process.exit(0);
});
JS
seen=$(node look.js 2>node.log | grep moved)
expected='moved: PROJ 452 m, proj4js 0 m'

echo "software:     proj4js 2.22.0, PROJ of GDAL in gdal3.js 2.8.1"
echo "a good guess: both move 140 E 37 N by the same 450 m on the way to WGS 84, or one says that it cannot"
echo "seen:         $seen"
[[ $seen == "$expected" ]] || { echo "CHANGED: it was $expected" >&2; exit 1; }
