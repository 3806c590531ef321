#!/usr/bin/env bash
# The GPU check: builds the CUDA preset without GDAL, LibTorch and cairo for this machine's GPU, and checks it.
#
#   scripts/gpu_check.sh [--out FOLDER] [part...]        parts: build tests validation sanitizers python bench; all when none is named
#
#   build       the program and the tests; also the test of LibTorch's gradients, where python3 has a LibTorch with CUDA
#   tests       the engine's tests on CPU and GPU, and those gradients
#   validation  the engine against closed forms and published values, on CPU and GPU
#   python      the Python module; its bodies on the GPU as tensors of LibTorch, where python3 has that, nanobind and Python.h
#   sanitizers  the tiny worlds of test_sim_sanitize under compute-sanitizer: memcheck, racecheck, initcheck
#   bench       times of the bench scenes and of the demo's trials
#
# Each part fits a call of ten minutes on 16 cores. Every part but `build` builds what is missing or out of date first.
# Needs nvcc, a GPU and Catch2 2.13 or 3. Headers that the machine lacks (nlohmann-json, CLI11, Catch2, xxhash) may lie in
# .carry/usr, laid out like /usr. Ends with status 1 when a test failed or a sanitizer found something; the logs are in the
# folder, out/gpu by default.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

results=out/gpu
parts=()
while (($# > 0)); do
  case $1 in
    --out) (($# > 1)) || fail "--out needs a folder"; results=$2; shift ;;
    build | tests | validation | sanitizers | python | bench) parts+=("$1") ;;
    *) fail "no part '$1'; there are: build tests validation sanitizers python bench, and --out FOLDER before them" ;;
  esac
  shift
done
((${#parts[@]} > 0)) || parts=(build tests validation sanitizers python bench)
mkdir -p "$results"
failed=()
engine='(sim|base_kernels|terrain_beds|terrain_soil_tests|pipeline_batch|learning_gpu)'
program=build/cuda-release/gonogo
use_carried_headers

# configure_gpu <log> [cmake arguments...]
configure_gpu() {
  local architecture
  architecture=$(gpu_architecture)
  cmake --preset cuda-release "-DCMAKE_CUDA_ARCHITECTURES=$architecture" -DGONOGO_GDAL=OFF -DGONOGO_PICTURES=OFF "${@:2}" \
    > "$1" 2>&1 || { tail -20 "$1"; fail "configuring failed"; }
}

# LibTorch has a build of its own, so that the program's needs none.
build_gradients() {
  local torch
  torch=$(python3 -c 'import torch; print(torch.utils.cmake_prefix_path if torch.version.cuda else "")' 2> /dev/null || true)
  if [[ -z $torch ]]; then
    say "gradients on the GPU: not built, python3 has no LibTorch with CUDA"
    return
  fi
  CMAKE_PREFIX_PATH="${CMAKE_PREFIX_PATH:-}:$torch" configure_gpu "$results/torch.log" -B build/torch -DGONOGO_TORCH=ON
  cmake --build build/torch -j "$(nproc)" --target test_learning_gpu_gradients >> "$results/torch.log" 2>&1 ||
    { tail -20 "$results/torch.log"; fail "building the gradients' test failed"; }
}

build_all() {
  local tests
  configure_gpu "$results/configure.log" -DGONOGO_TORCH=OFF
  grep 'The tests use Catch2' "$results/configure.log"
  mapfile -t tests < <(cmake --build build/cuda-release --target help | grep -oE "^test_(${engine}|validation)[a-z_]*" | sort -u)
  ((${#tests[@]} > 0)) || fail "the build has no test of the engine"
  cmake --build build/cuda-release -j "$(nproc)" --target gonogo "${tests[@]}" > "$results/build.log" 2>&1 ||
    { tail -40 "$results/build.log"; fail "the build failed"; }
  build_gradients
}

# run_ctest <part> <pattern of names>
run_ctest() {
  ctest --test-dir build/cuda-release -j 4 -R "^$2" --output-on-failure 2>&1 | tee "$results/$1.log" | tail -40 || failed+=("$1")
}

run_tests() {
  local gradients=build/torch/tests/learning/test_learning_gpu_gradients
  run_ctest tests "$engine"
  if [[ -x $gradients ]]; then
    "$gradients" || failed+=(gradients)
  fi
}

# A sanitizer that cannot work on this machine is told apart from one that found something.
run_sanitizers() {
  local sanitizer tool log status cases
  sanitizer=$(command -v compute-sanitizer) || fail "compute-sanitizer is not installed"
  for tool in memcheck racecheck initcheck; do
    log="$results/$tool.log"
    status=0
    cases=()
    [[ $tool != racecheck ]] || cases=("two short steps*")  # it follows every access to shared memory
    timeout 240 "$sanitizer" --tool "$tool" --error-exitcode 9 build/cuda-release/tests/sim/test_sim_sanitize "${cases[@]}" \
      > "$log" 2>&1 || status=$?
    echo "$tool: exit status $status, $(grep -E 'SUMMARY|not supported|All tests passed' "$log" | tail -2 | tr '\n' ' ')"
    if ((status != 0)); then
      if grep -q 'Device not supported' "$log"; then echo "  $tool does not work on this machine"; else failed+=("$tool"); fi
    fi
  done
}

# nanobind may lie in .carry/python.
run_python() {
  local missing
  [[ ! -d .carry/python ]] || export PYTHONPATH="$PWD/.carry/python"
  missing=$(python3 - <<'END'
import importlib.util, os, sysconfig
if not os.path.exists(sysconfig.get_paths()["include"] + "/Python.h"): print("Python.h")
print(*[name for name in ("nanobind", "numpy", "torch") if not importlib.util.find_spec(name)])
END
)
  if [[ -n ${missing//[[:space:]]/} ]]; then
    echo "Python on the GPU: not run, python3 lacks" $missing
    return
  fi
  configure_gpu "$results/python.log" -DGONOGO_TORCH=OFF -DGONOGO_PYTHON=ON "-DPython_EXECUTABLE=$(command -v python3)"
  cmake --build build/cuda-release -j "$(nproc)" --target gonogo_python >> "$results/python.log" 2>&1 ||
    { tail -20 "$results/python.log"; fail "building the Python module failed"; }
  python3 python/tests/on_gpu.py build/cuda-release/python/gonogo || failed+=(python)
}

bench() { "$program" bench "$@" --json | tail -1 | tee -a "$results/bench.jsonl"; }

run_bench() {
  local threads backend rolling chains device
  threads=$(nproc)
  for backend in cpu cuda; do
    bench bed --grain 0.05 --backend "$backend" --threads 1
  done
  for rolling in 0 0.1; do
    bench bed --grain 0.05 --worlds 40 --rolling "$rolling" --backend cuda --threads "$threads"
    bench bed --grain 0.05 --copies 40 --rolling "$rolling" --backend cuda --threads "$threads"
  done
  bench batch --beside-one --threads "$threads"
  bench batch --tiny --beside-one --threads "$threads"
  bench wheel --backend cuda --threads "$threads"
  bench wheel --substeps 1 --iterations 50 --backend cuda --threads "$threads"
  for solver in apgd spring_damper hertz; do
    bench tank --spheres 1000000 --seconds 0.02 --solver "$solver" --backend cuda
  done
  bench gibbs --threads 1 --chains 256
  for chains in 256 4096 65536 262144; do bench gibbs --backend cuda --chains "$chains"; done
  # Trials in steady state: the demo's, on the CPU's cores and in one batch on the GPU.
  for device in cpu cuda; do
    "$program" campaign run configs/studies/demo.json --out "$results/campaign_$device" --device "$device" 2>&1 | tail -2
  done
}

nvidia-smi --query-gpu=name,driver_version --format=csv,noheader
build_all
for part in "${parts[@]}"; do
  case $part in
    build) ;;
    tests) run_tests ;;
    validation) run_ctest validation validation ;;
    sanitizers) run_sanitizers ;;
    python) run_python ;;
    bench) run_bench ;;
  esac
done
if ((${#failed[@]} > 0)); then fail "failed: ${failed[*]}"; fi
