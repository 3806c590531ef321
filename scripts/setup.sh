#!/usr/bin/env bash
# Installs what the build needs and is missing, on Debian 12 or Ubuntu 24.04, as root or with sudo.
#   scripts/setup.sh [--tests] [--clang] [--no-torch] [--no-browser]
#     --tests       also what only tests use: Slurm and MPI on this machine, clang-format, a Python with nanobind and pytest
#     --clang       also Clang with its OpenMP, for the preset cpu-tsan, and clang-tidy
#     --no-torch    without LibTorch, for builds with -DGONOGO_TORCH=OFF
#     --no-browser  without Chromium, for builds with -DGONOGO_TESTS=OFF
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

packages=(
  g++ cmake ninja-build ccache git ca-certificates pkg-config  # build
  libeigen3-dev libhdf5-dev nlohmann-json3-dev libxxhash-dev   # base, sim
  libboost-graph-dev libcli11-dev libcairo2-dev libpng-dev     # pipeline
  libgdal-dev                                                  # terrain/raster
  catch2 hdf5-tools python3                                    # tests
)

torch=true
browser=true
python=false
for option in "$@"; do
  case $option in
    --tests)
      packages+=(slurm-wlm munge openmpi-bin libopenmpi-dev clang-format-14)  # engines of campaigns; format.sh
      packages+=(gdal-bin)                                                    # commands that sentences advise
      packages+=(python3-qgis)                                                # the plug-in, headless
      python=true
      ;;
    --clang) packages+=(clang libomp-dev llvm clang-tidy-14) ;;  # cpu-tsan, its symbolizer; tidy.sh
    --no-torch) torch=false ;;
    --no-browser) browser=false ;;
    *) fail "no option '$option'; there are --tests, --clang, --no-torch and --no-browser" ;;
  esac
done

is_installed() { [[ $(dpkg-query -W -f='${Status}' "$1" 2>/dev/null) == "install ok installed" ]]; }
has_candidate() { [[ $(LC_ALL=C apt-cache policy "$1" 2>/dev/null) == *"Candidate: "[0-9]* ]]; }

as_root() {
  if (($(id -u) == 0)); then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo "$@"
  else
    fail "installing packages needs root: run this as root, install sudo, or install by hand: $*"
  fi
}

apt_updated=false
apt_update() {
  $apt_updated && return
  say "fetching the package lists (apt-get update)"
  as_root apt-get update -qq
  apt_updated=true
}

apt_install() {
  say "installing with apt-get: $*"
  local install=(env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@")
  as_root "${install[@]}" >/dev/null && return
  apt_update  # lists that are too old name files that are gone
  as_root "${install[@]}" >/dev/null
}

# A python torch can be used when it is 1.13 or later and was built with the same C++ library interface as everything else.
python_torch_prefix() {
  "$1" -c '
import torch
version = tuple(int(part) for part in torch.__version__.split("+")[0].split(".")[:2])
if version >= (1, 13) and torch.compiled_with_cxx11_abi():
    print(torch.utils.cmake_prefix_path)' 2>/dev/null || true
}

use_torch_at() {
  mkdir -p .cache
  printf '%s\n' "$1" > .cache/torch_prefix
  say "LibTorch: $1"
}

install_torch_in_venv() {
  local venv=.cache/torch-venv
  say "LibTorch: no package libtorch-dev and no usable python torch; installing the CPU build of torch into $venv (about 1 GB)"
  is_installed python3-venv || apt_install python3-venv
  python3 -m venv "$venv"
  "$venv/bin/pip" install --quiet --index-url https://download.pytorch.org/whl/cpu 'torch>=2.6' ||
    "$venv/bin/pip" install --quiet 'torch>=2.6' || fail "could not install torch with pip; see the message above"
}

# The package of LibTorch multiplies matrices by the system's BLAS, whose reference version takes half of a training's time.
# The serial OpenBLAS gives the same bits for any number of threads; one that is there is kept.
provide_blas() {
  local blas
  blas=$(update-alternatives --query "libblas.so.3-$(uname -m)-linux-gnu" 2>/dev/null | sed -n 's/^Value: //p' || true)
  [[ $blas == */blas/libblas.so.3 ]] || return 0
  apt_install libopenblas0-serial || say "OpenBLAS could not be installed: training takes longer, all else is as with it"
}

provide_torch() {
  rm -f .cache/torch_prefix
  if is_installed libtorch-dev; then
    provide_blas
    return
  elif has_candidate libtorch-dev; then
    apt_install libtorch-dev
    provide_blas
    return
  fi
  local python prefix
  for python in python3 .cache/torch-venv/bin/python; do
    prefix=$(python_torch_prefix "$python")
    if [[ -n $prefix ]]; then
      use_torch_at "$prefix"
      return
    fi
  done
  install_torch_in_venv
  prefix=$(python_torch_prefix .cache/torch-venv/bin/python)
  [[ -n $prefix ]] || fail "torch was installed into .cache/torch-venv but cannot be imported"
  use_torch_at "$prefix"
}

# The tests of the page need a Chromium that is a package; where there is none (Ubuntu has it as a snap only), they are
# left out by scripts/test.sh, which says so.
provide_browser() {
  local name
  rm -f .cache/no_browser
  for name in chromium-headless-shell chromium chromium-browser google-chrome; do
    command -v "$name" >/dev/null && return
  done
  for name in chromium-headless-shell chromium; do
    if has_candidate "$name"; then
      apt_install "$name" fonts-dejavu-core
      return
    fi
  done
  mkdir -p .cache
  touch .cache/no_browser
  say "no package of Chromium here: the tests of the page will be left out"
}

# The Python module and its tests need packages of PyPI, named in pyproject.toml; where it cannot be reached, scripts/test.sh
# leaves them out and says so.
provide_python() {
  local venv=.cache/python requirements
  rm -f .cache/no_python
  [[ -f $(python3 -c 'import sysconfig; print(sysconfig.get_path("include"))')/Python.h ]] || apt_install python3-dev
  python3 -c 'import ensurepip' 2>/dev/null || apt_install python3-venv
  [[ -x $venv/bin/python ]] || python3 -m venv "$venv"
  mapfile -t requirements < <(python3 scripts/python_requirements.py)
  if ! "$venv/bin/pip" install --quiet --disable-pip-version-check "${requirements[@]}"; then
    touch .cache/no_python
    say "PyPI cannot be reached: the Python module and its tests will be left out"
  fi
}

command -v apt-get >/dev/null || fail "needs apt-get (Debian 12, Ubuntu 24.04); elsewhere install by hand: ${packages[*]} libtorch-dev"
missing=()
for package in "${packages[@]}"; do is_installed "$package" || missing+=("$package"); done
if ((${#missing[@]} > 0)); then
  for package in "${missing[@]}"; do has_candidate "$package" || apt_update; done
  apt_install "${missing[@]}"
fi
if $torch; then provide_torch; fi
if $browser; then provide_browser; fi
if $python; then provide_python; fi
say "everything the build needs is installed"
