#!/usr/bin/env bash
# Time to solution of our samplers and of those of dwave-samplers on ten families of problems, one core each.
# dwave-samplers comes from PyPI into a throw-away virtual environment. Takes some ten minutes.
#   scripts/time_to_solution.sh [gonogo [family...]]     exit status 77: PyPI cannot be reached
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

program=${1:-build/cpu-release/gonogo}
venv=$(mktemp -d)
install_from_pypi "$venv" "nothing was measured" 'dimod==0.12.*' 'dwave-samplers==1.*' 'dwave-networkx==0.8.*'
OMP_NUM_THREADS=1 "$venv/bin/python" tests/interop/time_to_solution.py "$program" "${@:2}"
