#!/usr/bin/env bash
# A study's campaign on all GPUs of this machine, from a bare checkout: builds the program where there is none yet (see
# common.sh), computes trials for so many seconds at most, and prints how many came and how busy the GPUs were. The same
# command goes on where it stopped; --checkpoint-every 0 because nothing but the clock stops it. CUDA_VISIBLE_DEVICES=0,1
# takes these GPUs alone; GONOGO_PROGRAM=FILE takes a program that is built already.
#
#   scripts/gpu_campaign.sh [study] [folder] [seconds] [places per worker] [workers] [options of gonogo campaign run...]
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
study=${1:-configs/studies/quarter_wheel_32mm.json} folder=${2:-out/quarter_wheel_32mm} seconds=${3:-480} places=${4:-64}
visible=${CUDA_VISIBLE_DEVICES:-$(nvidia-smi --query-gpu=index --format=csv,noheader | paste -sd,)}
gpus=$(tr ',' '\n' <<< "$visible" | wc -l)
gonogo=${GONOGO_PROGRAM:-build/cuda-release/gonogo}
[[ -n ${GONOGO_PROGRAM:-} ]] || build_gpu_program
mkdir -p "$folder"
done_trials() { "$gonogo" --json campaign status "$folder" 2> /dev/null | tail -1 | sed -n 's/.*"done":\([0-9]*\).*/\1/p'; }
before=$(done_trials || true) begin=$SECONDS
nvidia-smi -i "$visible" --query-gpu=utilization.gpu --format=csv,noheader,nounits -l 5 > "$folder/gpu_busy.txt" &
watch=$!
trap 'kill "$watch" 2> /dev/null || true' EXIT
status=0
timeout -s INT -k 30 "$seconds" "$gonogo" campaign run "$study" --out "$folder" --device cuda --places "$places" \
  --threads "$(nproc)" --workers "${5:-$gpus}" --checkpoint-every 0 "${@:6}" 2> "$folder/campaign.log" || status=$?
[ "$status" -eq 0 ] || [ "$status" -eq 124 ] || [ "$status" -eq 130 ] || { tail -5 "$folder/campaign.log"; exit "$status"; }
after=$(done_trials)
took=$((SECONDS - begin))
echo "$((after - ${before:-0})) trials in $took s on $gpus GPUs: $(((after - ${before:-0}) * 3600 / took / gpus)) per GPU and hour"
awk '{sum += $1; n++} END {if (n) printf "GPUs busy: %.0f %% of the time\n", sum / n}' "$folder/gpu_busy.txt"
"$gonogo" campaign status "$folder"
