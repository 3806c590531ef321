#!/usr/bin/env bash
# How a campaign scales over the GPUs of one host: settles the study's beds, then computes its trials from the first one on for
# equally many seconds on 1, 2, ... GPUs, a worker each, and prints trials and simulated seconds beside those of the first count.
# All workers begin at the same time with empty places, so that every run has the same start in it and ratios do not. Simulated
# seconds are the steadier measure: trials are of different lengths. Needs a new folder; builds like gpu_campaign.sh.
#
#   scripts/gpu_scaling.sh [study] [folder] [seconds] [places per worker] [numbers of GPUs...]
#   scripts/gpu_scaling.sh configs/studies/quarter_wheel_32mm.json out/scaling 200 64 1 2
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
study=${1:-configs/studies/quarter_wheel_32mm.json} folder=${2:-out/scaling} seconds=${3:-200} places=${4:-64}
counts=("${@:5}")
[ ${#counts[@]} -gt 0 ] || counts=(1 2)
[ ! -e "$folder" ] || fail "$folder exists; name a folder that does not, so that all runs begin anew"
there=$(nvidia-smi --list-gpus | wc -l) threads=$(nproc)
for count in "${counts[@]}"; do
  [[ $count =~ ^[1-9][0-9]*$ && $count -le $there ]] || fail "$count GPUs asked for; this machine has $there"
done

build_gpu_program
mkdir -p "$folder"
# Beds are settled once there is a worker: the coordinator settles them itself, and then starts it.
build/cuda-release/gonogo campaign run "$study" --out "$folder/beds" --device cuda --places 1 --workers 1 --threads "$threads" \
  2> "$folder/beds.log" &
coordinator=$!
trap 'kill -TERM "$coordinator" 2> /dev/null || true' EXIT
while kill -0 "$coordinator" 2> /dev/null && ! pgrep -P "$coordinator" > /dev/null; do sleep 0.5; done
kill -TERM "$coordinator" 2> /dev/null || { cat "$folder/beds.log" >&2; exit 1; }
wait "$coordinator" || true
trap - EXIT

first_trials='' first_simulated=''
for count in "${counts[@]}"; do
  out=$folder/gpus_$count
  # One large shard keeps all finished trials in the journal, where column 19 is drive_time [s].
  CUDA_VISIBLE_DEVICES=$(seq -s, 0 $((count - 1))) \
    scripts/gpu_campaign.sh "$study" "$out" "$seconds" "$places" "$count" --trials-per-shard 1000000 > "$out.txt"
  read -r trials simulated < <(awk -F, '{n++; s += $19} END {print n + 0, s + 0}' "$out"/trials/*.csv)
  ((trials > 0)) || fail "no trial ended within $seconds s on $count GPUs; give it more seconds"
  busy=$(sed -n 's/^GPUs busy: //p' "$out.txt")
  awk -v gpus="$count" -v trials="$trials" -v simulated="$simulated" -v seconds="$seconds" -v busy="$busy" \
    -v first_trials="${first_trials:-$trials}" -v first_simulated="${first_simulated:-$simulated}" -v first="${counts[0]}" \
    'BEGIN {printf "%d GPUs: %d trials, %.1f simulated s in %d s, busy %s; times %d GPU: trials %.2f, simulated s %.2f\n",
            gpus, trials, simulated, seconds, busy, first, trials / first_trials, simulated / first_simulated}'
  first_trials=${first_trials:-$trials} first_simulated=${first_simulated:-$simulated}
done
