#!/usr/bin/env bash
# A study's campaign on all GPUs of this machine, from a bare checkout: builds the CUDA preset without GDAL, LibTorch and
# cairo where there is no program yet, computes trials for so many seconds at most, and prints how many came and how busy
# the GPUs were. The same command goes on where it stopped; --checkpoint-every 0 because nothing but the clock stops it.
# Headers that the machine lacks (nlohmann-json, CLI11, xxhash) may lie in .carry/usr, laid out like /usr.
#
#   scripts/gpu_campaign.sh [study] [folder] [seconds] [places per worker] [workers]
set -euo pipefail
cd "$(dirname "$0")/.."
study=${1:-configs/studies/quarter_wheel_32mm.json} folder=${2:-out/quarter_wheel_32mm} seconds=${3:-480} places=${4:-64}
gonogo=build/cuda-release/gonogo
if [ ! -x "$gonogo" ]; then
  [ -d .carry/usr ] && export CMAKE_PREFIX_PATH="$PWD/.carry/usr" CPATH="$PWD/.carry/usr/include"
  mkdir -p build
  cmake --preset cuda-release -DGONOGO_TORCH=OFF -DGONOGO_GDAL=OFF -DGONOGO_PICTURES=OFF -DGONOGO_TESTS=OFF > build/gpu_configure.log
  cmake --build build/cuda-release -j "$(nproc)" --target gonogo > build/gpu_build.log 2>&1 || { grep -E 'error|FAILED' build/gpu_build.log | head; exit 1; }
fi
mkdir -p "$folder"
done_trials() { "$gonogo" --json campaign status "$folder" 2> /dev/null | tail -1 | sed -n 's/.*"done":\([0-9]*\).*/\1/p'; }
before=$(done_trials || true) begin=$SECONDS
nvidia-smi --query-gpu=utilization.gpu --format=csv,noheader,nounits -l 5 > "$folder/gpu_busy.txt" &
watch=$!
trap 'kill "$watch" 2> /dev/null || true' EXIT
status=0
timeout -s INT -k 30 "$seconds" "$gonogo" campaign run "$study" --out "$folder" --device cuda --places "$places" \
  --threads "$(nproc)" --workers "${5:-$(nvidia-smi --list-gpus | wc -l)}" --checkpoint-every 0 2> "$folder/campaign.log" || status=$?
[ "$status" -eq 0 ] || [ "$status" -eq 124 ] || [ "$status" -eq 130 ] || { tail -5 "$folder/campaign.log"; exit "$status"; }
after=$(done_trials)
took=$((SECONDS - begin)) gpus=$(nvidia-smi --list-gpus | wc -l)
echo "$((after - ${before:-0})) trials in $took s on $gpus GPUs: $(((after - ${before:-0}) * 3600 / took / gpus)) per GPU and hour"
awk '{sum += $1; n++} END {if (n) printf "GPUs busy: %.0f %% of the time\n", sum / n}' "$folder/gpu_busy.txt"
"$gonogo" campaign status "$folder"
