#!/bin/sh
# Remakes the files of this folder from the sample region with GDAL's programs (gdal-bin); see README.md.
set -eu
cd "$(dirname "$0")"
region=../../../configs/regions/sagehen
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
pack="-q -co COMPRESS=DEFLATE -co ZLEVEL=9"

# A window of the real elevation, and the same window with holes: every cell above 2060 m or below 1990 m is nodata.
gdal_translate $pack -co PREDICTOR=3 -srcwin 420 250 160 120 $region/elevation_10m.tif window.tif
gdal_translate -q -of AAIGrid -co FORCE_CELLSIZE=YES -co DECIMAL_PRECISION=6 window.tif "$scratch/window.asc"
awk 'NR <= 6 { print; next } { for (i = 1; i <= NF; ++i) printf "%s%s", ($i > 2060 || $i < 1990) ? -9999 : $i, i < NF ? " " : "\n" }' \
  "$scratch/window.asc" > "$scratch/holes.asc"
gdal_translate $pack -co PREDICTOR=3 -ot Float32 -a_nodata -9999 -a_srs EPSG:26911 "$scratch/holes.asc" holes.tif
gdalwarp -q -overwrite -t_srs EPSG:4326 -r cubic -co COMPRESS=DEFLATE window.tif degrees.tif

for name in window holes; do
  gdaldem slope -q -alg Horn $name.tif "$scratch/slope.tif"
  gdaldem aspect -q -alg Horn $name.tif "$scratch/aspect.tif"
  gdaldem hillshade -q -alg Horn -az 315 -alt 45 $name.tif "$scratch/hillshade.tif"
  gdal_translate $pack -co PREDICTOR=3 "$scratch/slope.tif" ${name}_slope.tif
  gdal_translate $pack -co PREDICTOR=3 "$scratch/aspect.tif" ${name}_aspect.tif
  gdal_translate $pack "$scratch/hillshade.tif" ${name}_hillshade.tif
done
rm -f ./*.aux.xml
