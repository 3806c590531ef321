#!/usr/bin/env bash
# Time to solution of our samplers and of those of dwave-samplers on ten families of problems, one core each.
# dwave-samplers comes from PyPI into a throw-away virtual environment. Takes some ten minutes. With --thrml, THRML is
# measured, too: it brings JAX, takes 0.7 GB, and compiles for another quarter of an hour.
#   scripts/time_to_solution.sh [--thrml] [gonogo [family...]]     exit status 77: PyPI cannot be reached
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

packages=('dimod==0.12.*' 'dwave-samplers==1.*' 'dwave-networkx==0.8.*')
if [[ ${1:-} == --thrml ]]; then
  packages+=('thrml==0.1.*')
  shift
fi
program=${1:-build/cpu-release/gonogo}
venv=$(mktemp -d)
install_from_pypi "$venv" "nothing was measured" "${packages[@]}"
# JAX computes on one thread only where XLA is told so.
export XLA_FLAGS="--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1" JAX_PLATFORMS=cpu
OMP_NUM_THREADS=1 "$venv/bin/python" tests/interop/time_to_solution.py "$program" "${@:2}"
