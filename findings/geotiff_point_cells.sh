#!/bin/bash
# The elevation models of Copernicus and SRTM are GeoTIFFs whose tie point is the middle of a cell (GTRasterTypeGeoKey 2,
# RasterPixelIsPoint). GDAL moves the raster by half a cell, so that its corner is a corner; geotiff.js, which reads the same
# key, gives the tie point as the corner. The same file lies half a cell farther north-west, or south-east, in the other.
set -euo pipefail
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"
npm install --silent --no-audit --no-fund geotiff@3.0.5 gdal3.js@2.8.1 >npm.log 2>&1 || { echo "geotiff 3.0.5 or gdal3.js 2.8.1 cannot be had" >&2; exit 77; }

cat >look.js <<'JS'
const fs = require('fs');
(async () => {
  const { writeArrayBuffer, fromFile } = await import('geotiff');
  const gdal = await require('gdal3.js/node')();
  for (const [kind, name] of [[1, 'area'], [2, 'point']]) {
    const heights = Float32Array.from({ length: 12 }, (_, i) => 100 + i);
    fs.writeFileSync(`${name}.tif`, Buffer.from(await writeArrayBuffer(heights, {
      width: 4, height: 3, ModelTiepoint: [0, 0, 0, 4000, 7000, 0], ModelPixelScale: [10, 10, 0],
      GTModelTypeGeoKey: 1, GTRasterTypeGeoKey: kind, ProjectedCSTypeGeoKey: 32654 })));
    const image = await (await fromFile(`${name}.tif`)).getImage();
    const about = await gdal.gdalinfo((await gdal.open(`${name}.tif`)).datasets[0]);
    const [west, , , north] = about.geoTransform;
    console.log(name, 'key', image.getGeoKeys().GTRasterTypeGeoKey, 'corner of geotiff.js',
      ...image.getBoundingBox().filter((_, i) => i === 0 || i === 3), 'of GDAL', west, north);
  }
  process.exit(0);
})();
JS
seen=$(node look.js 2>node.log | grep corner)
expected='area key 1 corner of geotiff.js 4000 7000 of GDAL 4000 7000
point key 2 corner of geotiff.js 4000 7000 of GDAL 3995 7005'

echo "software:     geotiff.js 3.0.5, GDAL $(grep -ao 'gdal-3\.[0-9.]*[0-9]' node_modules/gdal3.js/dist/package/gdal3WebAssembly.wasm | head -n 1 | cut -c6-) of gdal3.js 2.8.1"
echo "a good guess: one file, one place: both give 3995 7005 for cells of 10 m whose first middle is 4000 7000"
echo "seen:"
echo "$seen"
[[ $seen == "$expected" ]] || { echo "CHANGED: it was $expected" >&2; exit 1; }
