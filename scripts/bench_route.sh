#!/bin/sh
# Time and memory of `gonogo route` from corner to corner of 10 million cells, the whole command:
#   scripts/bench_route.sh <gonogo> <model.h5> <dataset.h5> [<cells along a side, 3163> [<threads, 2> [<more options>...]]]
# Makes the sample region larger by resampling. Needs gdal-bin and GNU time.
set -eu
gonogo=$1 model=$2 dataset=$3 side=${4:-3163} threads=${5:-2}
[ $# -le 5 ] && set -- || shift 5
region=$(cd "$(dirname "$0")/../configs/regions" && pwd)
scratch=${TMPDIR:-/tmp}/gonogo_bench_route_$side
mkdir -p "$scratch/sagehen"
[ -f "$scratch/sagehen/elevation_10m.tif" ] || {
  gdal_translate -q -co TILED=YES -co COMPRESS=DEFLATE -co PREDICTOR=3 -r cubic -outsize "$side" "$side" \
    "$region/sagehen/elevation_10m.tif" "$scratch/elevation.tif"
  mv "$scratch/elevation.tif" "$scratch/sagehen/elevation_10m.tif"
}
cp "$region/sagehen/usda_texture_30m.tif" "$scratch/sagehen/"
cp "$region/sagehen.json" "$scratch/"
/usr/bin/time -f "%e s, %U s of processor time, %M KiB" "$gonogo" route --model "$model" --dataset "$dataset" \
  --whole-vehicle hmmwv --region "$scratch/sagehen.json" --from 214700,4368000 --to 221600,4373400 --cost fastest \
  --out "$scratch/route.gpkg" --threads "$threads" "$@"
