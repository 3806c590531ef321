#!/usr/bin/env bash
# Scores of the learning on the frozen quarter-wheel trials (docs/learning.md), many processes side by side.
#
#   scripts/learning_scores.sh [--out FOLDER] [--seconds N] [--study FILE] [--trials LIST] [--build FOLDER]
#                              [part...] [name=value...]
#
#   build    the program and the study of joint distributions, without CUDA, GDAL and cairo, in build/scores or --build
#   seeds    trains four seeds and evaluates them, and rows of their machines through QUBO export, sampler and import:
#            FOLDER/seed32 ... seed35 with model.h5, rows.csv, evaluation.json, scores.txt
#   c12      a machine for a D-Wave 2X with 2 % dead qubits, its rows through the emulator, P(go) at 20 slopes: FOLDER/c12
#   thinned  two seeds on trials that crowd at the boundary: FOLDER/thinned32, thinned33; name=value are learning settings
#   active   a machine on 900 trials of an active design with a known boundary: FOLDER/active; name=value likewise
#   curve    the learning curve at 100, 300, 1,000 and 3,004 trials, or those of --trials: FOLDER/curve
#
# All parts when none is named. seeds, c12, thinned, active and curve run at the same time, and together keep all cores busy. After N
# seconds, the build included, everything stops; what is finished is kept, and the same command goes on. FOLDER
# (out/scores by default) gets summary.txt and curve.csv of what is there.
# Needs Debian's libtorch-dev or python3's LibTorch, and headers as scripts/gpu_check.sh does.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

out=out/scores build=build/scores seconds=3600 study=configs/studies/quarter_wheel_32mm.json
dataset=data/quarter_wheel_32mm/dataset.h5 trials=3004,1000,300,100
parts=() settings=()
while (($# > 0)); do
  case $1 in
    --out | --seconds | --study | --trials | --build) (($# > 1)) || fail "$1 needs a value"; declare "${1#--}=$2"; shift ;;
    build | seeds | c12 | thinned | active | curve) parts+=("$1") ;;
    *=*) settings+=("$1") ;;
    *) fail "no part '$1'; there are: build seeds c12 thinned active curve, --out, --seconds, --study, --trials and --build" ;;
  esac
  shift
done
[[ $seconds =~ ^[0-9]+$ ]] || fail "--seconds is '$seconds'; give whole seconds, at least 1"
((${#parts[@]} > 0)) || parts=(build seeds c12 thinned active curve)
mkdir -p "$out"
gonogo=$build/gonogo-learn joint=$build/tests/pipeline/learning_joint
cores=$(nproc)

has_part() { [[ " ${parts[*]} " == *" $1 "* ]]; }
# within COMMAND...: stopped by the signal of Ctrl-C 20 s before the time is over, and killed when it is.
within() {
  local left=$((seconds - SECONDS - 20))
  ((left > 0)) || return 124
  timeout -s INT -k 20 "$left" nice -n 5 "$@"
}

build_programs() {
  local prefix=${CMAKE_PREFIX_PATH:-}
  use_carried_headers
  if [[ ! -s .cache/torch_prefix ]] && python3 -c 'import torch' 2> /dev/null; then
    prefix+=:$(python3 -c 'import torch; print(torch.utils.cmake_prefix_path)')
  fi
  # LibTorch with CUDA looks for nvcc and wants an architecture, though nothing of ours is compiled for a GPU here.
  local cuda=()
  ! command -v nvidia-smi > /dev/null || cuda=("-DCMAKE_CUDA_ARCHITECTURES=$(gpu_architecture)")
  CMAKE_PREFIX_PATH="${CMAKE_PREFIX_PATH:-}:$prefix" configure cpu-release "${cuda[@]}" -B "$build" -DGONOGO_TORCH=ON \
    -DGONOGO_GDAL=OFF -DGONOGO_PICTURES=OFF -DGONOGO_MPI=OFF -DGONOGO_BROWSER_TESTS=OFF > "$out/configure.log" 2>&1 ||
    { tail -20 "$out/configure.log"; fail "configuring failed"; }
  within cmake --build "$build" -j "$(build_jobs)" --target gonogo-learn learning_joint > "$out/build.log" 2>&1 ||
    { grep -E 'error|FAILED' "$out/build.log" | head -20; fail "the build failed or ran out of time: $out/build.log"; }
}

# evaluated FOLDER: scores of its model, and of its rows.csv.
evaluated() {
  [[ -f $1/evaluation.json ]] ||
    within "$gonogo" evaluate --model "$1/model.h5" --dataset "$dataset" --rows "$1/rows.csv" --out "$1" > "$1/scores.txt"
}

train_seed() {
  local folder=$out/seed$1
  mkdir -p "$folder"
  [[ -f $folder/model.h5 ]] ||
    within "$gonogo" train --dataset "$dataset" --study "$study" --hold-out 1000 --seed "$1" --out "$folder/model.h5" || return
  if [[ ! -f $folder/rows.csv ]]; then
    within "$gonogo" qubo export --model "$folder/model.h5" --out "$folder/problem.json" || return
    within "$gonogo" qubo sample "$folder/problem.json" --sampler tempering --reads 1200 --seed "$1" --out "$folder/answer.json" || return
    within "$gonogo" qubo import --problem "$folder/problem.json" --answer "$folder/answer.json" --decode discard --inside \
      --rows "$folder/rows.csv" || return
  fi > "$folder/qubo.txt"
  evaluated "$folder"
}

# P(go or slow-go) at 20 slopes, by the emulator and by the machine's own sums.
c12_slopes() {
  local folder=$1 slope
  for slope in {-20..34..3} 35; do
    within "$gonogo" qubo export --model "$folder/model.h5" --clamp "slope_along=$slope" --out "$folder/clamped.json" &&
      within "$gonogo" qubo sample "$folder/clamped.json" --sampler emulator --dead-share 0.02 --reads 1000 \
        --out "$folder/clamped_answer.json" &&
      within "$gonogo" --json qubo import --problem "$folder/clamped.json" --answer "$folder/clamped_answer.json" \
        > "$folder/slope_$slope.json" || return
  done > "$folder/slopes.log"
}

train_c12() {
  local folder=$out/c12
  mkdir -p "$folder"
  [[ -f $folder/model.h5 ]] || within "$gonogo" train --dataset "$dataset" --study configs/studies/quarter_wheel_c12.json \
    --hold-out 1000 --out "$folder/model.h5" || return
  [[ -f $folder/rows.csv ]] || within "$gonogo" sample --model "$folder/model.h5" --sampler emulator --dead-share 0.02 \
    --rows 1000 --out "$folder/rows.csv" > "$folder/emulator.txt" || return
  evaluated "$folder" && c12_slopes "$folder"
}

thinned_seed() {
  local folder=$out/thinned$1
  mkdir -p "$folder"
  [[ ! -f $folder/finished ]] || return 0
  within "$joint" thinned=1 "seeds=$1" "out=$folder" "dataset=$dataset" "${settings[@]}" > "$folder/scores.txt" &&
    touch "$folder/finished"
}

active_design() {
  local folder=$out/active
  mkdir -p "$folder"
  [[ ! -f $folder/finished ]] || return 0
  within "$joint" active=900 hold_out=300 importance=0 "out=$folder" "${settings[@]}" > "$folder/scores.txt" &&
    touch "$folder/finished"
}

# One of several processes that share the models.
curve_worker() {
  within "$gonogo" learning-curve --dataset "$dataset" --study "$study" --trials "$trials" --subsets 5 \
    --out "$out/curve" > "$out/curve/worker$1.txt"
}

# start THREADS LOG FUNCTION ARGUMENT: in the background, with so many threads.
start() { OMP_NUM_THREADS=$1 "$3" "$4" 2> "$2" & }

run_parts() {
  local seed worker wide=$(((cores + 7) / 8)) workers=$(((cores + 1) / 2))
  ((workers <= 16)) || workers=16  # as many models as the curve has
  if has_part seeds; then
    for seed in 32 33 34 35; do start "$wide" "$out/seed$seed.log" train_seed "$seed"; done
  fi
  if has_part c12; then start "$wide" "$out/c12.log" train_c12 ""; fi
  if has_part thinned; then
    for seed in 32 33; do start 1 "$out/thinned$seed.log" thinned_seed "$seed"; done
  fi
  if has_part active; then start 1 "$out/active.log" active_design ""; fi
  if has_part curve; then
    mkdir -p "$out/curve"
    for ((worker = 1; worker <= workers; ++worker)); do start 1 "$out/curve$worker.log" curve_worker "$worker"; done
  fi
  wait
}

summary() {
  python3 - "$out" <<'PYTHON'
import collections, glob, json, sys
out = sys.argv[1]
for file in sorted(glob.glob(out + "/*/scores.txt")):
    print(file, open(file).read(), sep="\n")

def row(scores, kind):
    of = scores["joint"]["kinds"][kind]
    return [of["auc_bins"], of["auc_values"], of["trained_brier"], scores["scores"]["model"]["brier"],
            scores["scores"]["model"]["calibration_error"]]

seeds = [json.load(open(file)) for file in sorted(glob.glob(out + "/seed*/evaluation.json"))]
for kind in ("given", "machine", "trials"):
    of = [row(scores, kind) for scores in seeds if kind in scores.get("joint", {}).get("kinds", {})]
    if of:
        print(f"rows of kind {kind}, mean of {len(of)} seeds: AUC in bins {sum(r[0] for r in of) / len(of):.3f}, "
              f"of values {sum(r[1] for r in of) / len(of):.3f}, Brier score trained on them "
              f"{sum(r[2] for r in of) / len(of):.4f}; the model's own {sum(r[3] for r in of) / len(of):.4f}, "
              f"calibration error {sum(r[4] for r in of) / len(of):.4f}")

answers = {int(file.split("slope_")[1][:-5]): json.load(open(file)) for file in glob.glob(out + "/c12/slope_*.json")}
apart, silent = {}, []
for slope, answer in sorted(answers.items()):
    passed = [sum(answer["outcomes"][o][key] for o in ("go", "slow_go")) for key in ("frequency", "machine")]
    verdict = answer["bias"]["verdict"]
    apart[slope] = abs(passed[0] - passed[1])
    silent += [slope] if apart[slope] > 0.05 and verdict != "biased" else []
    print(f"c12, slope {slope:4d}: P(go or slow-go) by the emulator {passed[0]:.4f}, exact {passed[1]:.4f}; bias: {verdict}")
if apart:
    print(f"c12: {max(apart.values()):.4f} apart at most; more than 0.05 apart and not named biased: {silent or 'none'}")
scores = [json.load(open(file))["scores"] for file in sorted(glob.glob(out + "/curve/*/scores.json"))]
brier = collections.defaultdict(lambda: collections.defaultdict(list))
with open(out + "/curve.csv", "w") as csv:
    csv.write("trials,subset,forecaster,brier,log_loss_nat\n")
    for point in scores:
        for name, value in point["brier"].items():
            csv.write(f"{point['trials']},{point['subset']},{name},{value!r},{point['log_loss_nat'][name]!r}\n")
            brier[point["trials"]][name].append(value)
for trials, by_name in sorted(brier.items()):
    means = sorted((sum(values) / len(values), name) for name, values in by_name.items())
    print(f"{trials} trials, {len(by_name['model'])} subsets, Brier score:", ", ".join(f"{name} {mean:.4f}" for mean, name in means))
PYTHON
}

if has_part build; then build_programs; fi
[[ -x $gonogo && -x $joint ]] || fail "no program in $build; name the part build as well"
run_parts
summary | tee "$out/summary.txt"
say "$SECONDS s; logs and models: $out"
