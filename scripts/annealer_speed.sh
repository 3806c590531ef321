#!/usr/bin/env bash
# Our simulated annealer beside that of dwave-samplers on the same problems and machine, one core each, at the same
# quality (mean energy of the rows). dwave-samplers comes from PyPI into a throw-away virtual environment.
#   scripts/annealer_speed.sh [gonogo]     exit status 77: PyPI cannot be reached; 1: a factor is below 3
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

program=${1:-build/cpu-release/gonogo}
venv=$(mktemp -d)
install_from_pypi "$venv" "nothing was measured" 'dimod==0.12.*' 'dwave-samplers==1.*'
OMP_NUM_THREADS=1 "$venv/bin/python" tests/interop/annealer_speed.py "$program"
