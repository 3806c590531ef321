#!/usr/bin/env bash
# Long runs of whole vehicles for a GPU: the moving patch against long fixed beds, folded beds against wide ones, the
# HMMWV's drawbar curve beside semi-empirical bands, every type of trial, the M113, and three runs of the original
# study's bin. Builds the CUDA preset without GDAL, LibTorch and cairo when there is no program yet. One JSON line per
# run in results.jsonl, texts in run.log.
#
#   scripts/vehicle_checks.sh [results-folder]
#
# The friction angle of a table does not depend on the size of its grains (docs/soils.md: triaxial tests without gravity), so
# that the 32 mm table, whose steps of 1 ms all these runs take, serves coarser grains here.
set -uo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
results=${1:-out/vehicles}
mkdir -p "$results"
use_carried_headers
gonogo=build/cuda-release/gonogo
architecture=$(gpu_architecture) || exit 1
cmake --preset cuda-release "-DCMAKE_CUDA_ARCHITECTURES=$architecture" -DGONOGO_TORCH=OFF -DGONOGO_GDAL=OFF -DGONOGO_PICTURES=OFF > "$results/configure.log" || exit 1
cmake --build build/cuda-release -j "$(nproc)" --target gonogo > "$results/build.log" 2>&1 || { tail -40 "$results/build.log"; exit 1; }
coarse="$results/grains_0.064.json"
fine=configs/soils/calibration_32mm.json
sed 's/"grain_diameter_m": 0.032/"grain_diameter_m": 0.064/' "$fine" > "$coarse"

failed=0
run() {
  local begin=$SECONDS out
  echo "== $*" | tee -a "$results/run.log"
  out=$(timeout 600 "$gonogo" --json "$@" 2>> "$results/run.log") || { echo "   ended with an error"; failed=$((failed + 1)); }
  echo "$out" | tail -1 | tee -a "$results/results.jsonl"
  echo "   $((SECONDS - begin)) s" | tee -a "$results/run.log"
}
threads=$(nproc)
run validate patch --soil "$coarse" --seeds 160 --distance 6 --gpu --threads "$threads"
run validate patch --vehicle hmmwv --soil "$coarse" --seeds 4 --distance 12 --gpu --threads "$threads"
run validate folded --soil "$coarse" --seeds 8 --distance 6 --friction-angle 26 --slope 4 --gpu --threads "$threads"
run validate drawbar --soil "$coarse" --friction-angle 32 --seeds 4 --gpu --threads "$threads" --out "$results"
for trial in climb step:height_m=0.15 ditch:width_m=1,depth_m=0.2 crossing:length_m=2,friction_angle_deg=20; do
  run simulate --vehicle hmmwv --soil "$coarse" --trial "$trial" --gpu --threads "$threads"
done
run simulate --vehicle hmmwv --soil "$coarse" --trial side_slope --cross-slope 12 --gpu --threads "$threads"
run simulate --vehicle hmmwv --soil "$coarse" --slope 12 --gpu --threads "$threads"
for vehicle in fed_alpha viper; do
  run simulate --vehicle "$vehicle" --soil "$coarse" --slope 5 --set commanded_speed=0.5 --gpu --threads "$threads"
done
run validate vehicles m113 --gpu
run simulate --vehicle m113 --soil "$coarse" --slope 8 --gpu --threads "$threads"
printf '0 10 2500 0.8 100\n15 10 2500 0.8 100\n30 10 2000 0.4 100\n' > "$results/original.txt"
for line in 1 2 3; do
  run original "$results/original.txt" --line "$line" --out "$results/original" --gpu --threads "$threads"
done
run validate drawbar --soil "$fine" --folded --friction-angle 32 --seeds 4 --gpu --threads "$threads"
echo "$failed runs ended with an error"
