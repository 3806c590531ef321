#!/usr/bin/env bash
# The whole GPU check in one call: builds the CUDA preset without GDAL, LibTorch and cairo, runs the engine's tests on CPU and
# GPU, gradients by a LibTorch with CUDA where python3 has one, runs the tiny worlds of test_sim_sanitize under compute-sanitizer (memcheck, racecheck, initcheck), and times the bench
# scenes. Needs nvcc and a GPU. Headers that the machine lacks (nlohmann-json, CLI11, Catch2, xxhash) may lie in .carry/usr, laid
# out like /usr. Ends with status 1 when a test failed or a sanitizer found something; the logs are in the results folder.
#
#   scripts/gpu_check.sh [results-folder]
set -euo pipefail
cd "$(dirname "$0")/.."
results=${1:-out/gpu}
mkdir -p "$results"
failed=()
[ -d .carry/usr ] && export CMAKE_PREFIX_PATH="$PWD/.carry/usr" CPATH="$PWD/.carry/usr/include"
nvidia-smi --query-gpu=name,driver_version --format=csv,noheader
cmake --preset cuda-release -DGONOGO_TORCH=OFF -DGONOGO_GDAL=OFF -DGONOGO_PICTURES=OFF > "$results/configure.log"
tests=$(cmake --build build/cuda-release --target help | grep -oE '^test_(sim|validation|base_kernels|terrain_beds|pipeline_batch|learning_gpu)[a-z_]*' | sort -u)
cmake --build build/cuda-release -j "$(nproc)" --target gonogo $tests > "$results/build.log" 2>&1 || { tail -40 "$results/build.log"; exit 1; }
ctest --test-dir build/cuda-release -j 4 -R '^(sim|validation|base_kernels|terrain_beds|pipeline_batch|learning_gpu)' --output-on-failure 2>&1 | tee "$results/ctest.log" | tail -40 || failed+=(tests)

# Gradients by LibTorch on the GPU, where python3 has a LibTorch with CUDA; a build of its own, so that the program's needs none.
torch=$(python3 -c 'import torch; print(torch.utils.cmake_prefix_path if torch.version.cuda else "")' 2> /dev/null || true)
if [ -n "$torch" ]; then
  CMAKE_PREFIX_PATH="${CMAKE_PREFIX_PATH:-}:$torch" cmake --preset cuda-release -B build/torch -DGONOGO_TORCH=ON -DGONOGO_GDAL=OFF -DGONOGO_PICTURES=OFF > "$results/torch.log" 2>&1 &&
    cmake --build build/torch -j "$(nproc)" --target test_learning_gpu_gradients >> "$results/torch.log" 2>&1 &&
    build/torch/tests/learning/test_learning_gpu_gradients || { tail -20 "$results/torch.log"; failed+=(gradients); }
else
  echo "gradients on the GPU: not run, python3 has no LibTorch with CUDA"
fi

# A sanitizer that cannot work on this machine is told apart from one that found something.
sanitizer=$(command -v compute-sanitizer || echo /usr/local/cuda/bin/compute-sanitizer)
for tool in memcheck racecheck initcheck; do
  log="$results/$tool.log"
  status=0
  cases=()
  [ "$tool" = racecheck ] && cases=("two short steps*")  # it follows every access to shared memory
  timeout 240 "$sanitizer" --tool "$tool" --error-exitcode 9 build/cuda-release/tests/sim/test_sim_sanitize "${cases[@]}" > "$log" 2>&1 || status=$?
  echo "$tool: exit status $status, $(grep -E 'SUMMARY|not supported|All tests passed|No such file' "$log" | tail -2 | tr '\n' ' ')"
  if [ "$status" -ne 0 ]; then
    if grep -q 'Device not supported' "$log"; then echo "  $tool does not work on this machine"; else failed+=("$tool"); fi
  fi
done

bench() { build/cuda-release/gonogo bench "$@" --json | tail -1 | tee -a "$results/bench.jsonl"; }
for backend in cpu cuda; do
  bench bed --grain 0.05 --backend "$backend" --threads 1
done
for rolling in 0 0.1; do
  bench bed --grain 0.05 --worlds 40 --rolling "$rolling" --backend cuda --threads "$(nproc)"
  bench bed --grain 0.05 --copies 40 --rolling "$rolling" --backend cuda --threads "$(nproc)"
done
bench batch --beside-one --threads "$(nproc)"
bench batch --tiny --beside-one --threads "$(nproc)"
bench wheel --backend cuda --threads "$(nproc)"
bench wheel --substeps 1 --iterations 50 --backend cuda --threads "$(nproc)"
bench gibbs --threads 1 --chains 256
for chains in 256 4096 65536 262144; do bench gibbs --backend cuda --chains "$chains"; done
# Trials in steady state: the demo's, on the CPU's cores and in one batch on the GPU.
for device in cpu cuda; do
  build/cuda-release/gonogo campaign run configs/studies/demo.json --out "$results/campaign_$device" --device "$device" 2>&1 | tail -2
done
if [ "${#failed[@]}" -gt 0 ]; then echo "failed: ${failed[*]}"; exit 1; fi
