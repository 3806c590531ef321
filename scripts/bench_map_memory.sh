#!/bin/sh
# Peak memory of maps by the number of their cells:
#   scripts/bench_map_memory.sh <gonogo> <model.h5> <dataset.h5> [<seconds of the unfinished maps, 300>] [<threads, 2>]
# Two things are measured, with all layers:
#   unfinished  the sample region fills all cells; the map is stopped after so many seconds, most of them making blocks
#   whole       from the first block to the page; the sample region fills 3,000 x 3,000 cells, the others have no elevation
# at the sides in UNFINISHED ("10000 40000") and WHOLE ("5000 10000"). With enough seconds (100000) the unfinished ones
# are whole maps too: 40,000 x 40,000 cells take half an hour and 28 GiB of disk. Needs gdal-bin, python3 and GNU time.
set -eu
gonogo=$1 model=$2 dataset=$3 seconds=${4:-300} threads=${5:-2}
region=$(cd "$(dirname "$0")/../configs/regions" && pwd)
scratch=${TMPDIR:-/tmp}/gonogo_bench_map_memory

make_region() {  # kind side
  folder=$scratch/$1_$2
  rm -rf "$folder"
  mkdir -p "$folder/sagehen"
  gdal_translate -q -of VRT -r cubic -outsize "$2" "$2" "$region/sagehen/elevation_10m.tif" "$folder/sagehen/elevation.vrt"
  [ "$1" = unfinished ] || python3 - "$folder/sagehen/elevation.vrt" <<'PYTHON'
import re, sys
text = open(sys.argv[1]).read()
text = re.sub(r"<GeoTransform>.*?</GeoTransform>", "<GeoTransform>209303.3333, 2.4833333333333334, 0, 4378110, 0, -2.3"
              "</GeoTransform>", text)  # the region lies where it lay
text = re.sub(r"<DstRect[^>]*/>", '<DstRect xOff="2000" yOff="2000" xSize="3000" ySize="3000" />', text)
open(sys.argv[1], "w").write(text)
PYTHON
  cp "$region/sagehen/usda_texture_30m.tif" "$folder/sagehen/"
  sed 's/elevation_10m.tif/elevation.vrt/' "$region/sagehen.json" > "$folder/region.json"
}

for kind in unfinished whole; do
  sides=${UNFINISHED-10000 40000}
  [ $kind = unfinished ] || sides=${WHOLE-5000 10000}
  for side in $sides; do
    make_region $kind $side
    limit=$seconds
    [ $kind = unfinished ] || limit=100000
    status=0
    /usr/bin/time -f "%e %M" -o "$folder/time" timeout --signal=INT "$limit" "$gonogo" map --model "$model" \
      --dataset "$dataset" --whole-vehicle hmmwv --region "$folder/region.json" --out "$folder/map" --threads "$threads" \
      > "$folder/log" 2> "$folder/progress" || status=$?
    tail -n 1 "$folder/time" | awk -v kind=$kind -v side=$side -v status=$status \
      '{ printf "%-10s %d x %d cells: %.0f MiB, %.0f s, exit status %d\n", kind, side, side, $2 / 1024, $1, status }'
    tail -n 1 "$folder/progress"
  done
done
