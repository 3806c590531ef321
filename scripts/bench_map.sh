#!/bin/sh
# Time and memory of a large map beside GDAL's own way of writing the same bands:
#   scripts/bench_map.sh <gonogo> <model.h5> <dataset.h5> [<cells along a side, 10000>] [<threads, 2>]
# Makes the sample region larger by resampling, maps it, then lets gdal_translate -of COG write every band again with the
# same compression, and prints both times, their ratio and the peak memory. Needs gdal-bin and GNU time.
set -eu
gonogo=$1 model=$2 dataset=$3 side=${4:-10000} threads=${5:-2}
region=$(cd "$(dirname "$0")/../configs/regions" && pwd)
scratch=${TMPDIR:-/tmp}/gonogo_bench_map_$side
mkdir -p "$scratch/sagehen"
pack="-q -co TILED=YES -co COMPRESS=DEFLATE -co PREDICTOR"
[ -f "$scratch/sagehen/elevation_10m.tif" ] || {
  gdal_translate $pack=3 -r cubic -outsize "$side" "$side" "$region/sagehen/elevation_10m.tif" "$scratch/elevation.tif"
  mv "$scratch/elevation.tif" "$scratch/sagehen/elevation_10m.tif"
}
cp "$region/sagehen/usda_texture_30m.tif" "$scratch/sagehen/"
cp "$region/sagehen.json" "$scratch/"
rm -rf "$scratch/map" "$scratch/copy"
/usr/bin/time -f "%e %M" -o "$scratch/ours" "$gonogo" map --model "$model" --dataset "$dataset" --whole-vehicle hmmwv \
  --region "$scratch/sagehen.json" --out "$scratch/map" --threads "$threads" > "$scratch/log"
mkdir "$scratch/copy"
start=$(date +%s.%N)
for layer in "$scratch"/map/*.tif; do
  resampling=AVERAGE
  gdalinfo "$layer" | grep -q 'Type=Byte' && resampling=MODE
  gdal_translate -q -of COG -co COMPRESS=DEFLATE -co PREDICTOR=YES -co NUM_THREADS="$threads" \
    -co OVERVIEW_RESAMPLING=$resampling "$layer" "$scratch/copy/layer.tif"
  rm "$scratch/copy/layer.tif"
done
end=$(date +%s.%N)
read -r seconds kilobytes < "$scratch/ours"
echo "$side x $side cells, $threads threads, $(ls "$scratch"/map/*.tif | wc -l) bands"
echo "$seconds $kilobytes $start $end" | awk '{ gdal = $4 - $3
  printf "gonogo map %.1f s, %.0f MiB; gdal_translate -of COG of the same bands %.1f s; ratio %.2f\n", $1, $2 / 1024, gdal, $1 / gdal }'
