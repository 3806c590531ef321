# shellcheck shell=bash
# Shared by the scripts: what they say, and how the program is configured and built on this machine.
# Source it after `set -euo pipefail`; it changes to the root of the source tree.

cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1
export PATH="$PATH:/usr/local/cuda/bin"
export CCACHE_BASEDIR=$PWD  # so that clones and presets share what was compiled

say() { printf '==> %s\n' "$*"; }
fail() { printf '%s: %s\n' "$(basename "$0")" "$*" >&2; exit 1; }

# Jobs for the build: one per core, but leave 1.5 GB of memory to each compiler (LibTorch's headers need it).
build_jobs() {
  local cores memory_kb by_memory
  cores=$(nproc)
  memory_kb=$(awk '/^MemAvailable:/ {print $2}' /proc/meminfo)
  by_memory=$((memory_kb / 1500000))
  ((by_memory < 1)) && by_memory=1
  echo $((cores < by_memory ? cores : by_memory))
}

# configure <preset> [cmake arguments...]: adds what depends on this machine.
configure() {
  local preset=$1
  shift
  local arguments=("$@")
  if command -v ccache >/dev/null; then
    # The slack is what ccache asks for where headers are precompiled; no file of ours uses __TIME__.
    arguments+=("-DCMAKE_CXX_COMPILER_LAUNCHER=env;CCACHE_SLOPPINESS=pch_defines,time_macros;ccache")
  fi
  if [[ -s .cache/torch_prefix ]]; then
    arguments+=("-DCMAKE_PREFIX_PATH=$(cat .cache/torch_prefix)")
  fi
  if ! grep -qw avx2 /proc/cpuinfo; then
    say "this processor has no AVX2: building for the compiler's default processor instead of x86-64-v3"
    arguments+=(-DCMAKE_CXX_FLAGS=)
  fi
  say "configuring preset $preset"
  cmake --preset "$preset" "${arguments[@]}"
}

# build <preset> [targets...]: everything when no target is named.
build() {
  local preset=$1
  shift
  local targets=()
  (($# > 0)) && targets=(--target "$@")
  say "building ${*:-everything} with $(build_jobs) jobs"
  cmake --build --preset "$preset" -j "$(build_jobs)" "${targets[@]}"
}

# Headers that a GPU machine lacks (nlohmann-json, CLI11, Catch2, xxhash) may lie in .carry/usr, laid out like /usr.
use_carried_headers() {
  [[ ! -d .carry/usr ]] || export CMAKE_PREFIX_PATH="$PWD/.carry/usr" CPATH="$PWD/.carry/usr/include"
}

# Compute capability of the first GPU of this machine, as CMake writes it: 90. One architecture builds in half the time of
# the two that are built by default.
gpu_architecture() {
  local capability
  capability=$(nvidia-smi --query-gpu=compute_cap --format=csv,noheader | sed -n 1p)
  [[ $capability =~ ^[0-9]+\.[0-9]+$ ]] || fail "nvidia-smi names no compute capability: '$capability'"
  echo "${capability/./}"
}

# The program for campaigns on GPUs, from a bare checkout: the CUDA preset without GDAL, LibTorch and cairo, where there is no
# program yet. A machine without a GPU builds for all architectures of the preset.
build_gpu_program() {
  [[ ! -x build/cuda-release/gonogo ]] || return 0
  local architecture=()
  ! command -v nvidia-smi > /dev/null || architecture=("-DCMAKE_CUDA_ARCHITECTURES=$(gpu_architecture)")
  use_carried_headers
  mkdir -p build
  cmake --preset cuda-release "${architecture[@]}" -DGONOGO_TORCH=OFF -DGONOGO_GDAL=OFF \
    -DGONOGO_PICTURES=OFF -DGONOGO_TESTS=OFF > build/gpu_configure.log
  cmake --build build/cuda-release -j "$(nproc)" --target gonogo > build/gpu_build.log 2>&1 ||
    { grep -E 'error|FAILED' build/gpu_build.log | head; exit 1; }
}

# install_from_pypi <folder> <what is lost without them> <packages...>: into a virtual environment there, which goes when the
# script ends. Exit status 77 where PyPI cannot be reached.
install_from_pypi() {
  # shellcheck disable=SC2064  # the folder of now
  trap "rm -rf '$1'" EXIT
  python3 -m venv "$1"
  if ! "$1/bin/pip" install --quiet "${@:3}"; then
    say "$(basename "$0" .sh): PyPI cannot be reached; $2"
    exit 77
  fi
}
