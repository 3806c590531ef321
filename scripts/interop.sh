#!/usr/bin/env bash
# The program's files against the real clients, installed from PyPI into a throw-away virtual environment, and the test
# rasters and shapes of other packages against the program.
#   scripts/interop.sh [gonogo]        exit status 77: PyPI or Debian's packages cannot be reached, not all was checked
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

program=${1:-build/cpu-release/gonogo}
venv=$(mktemp -d)
install_from_pypi "$venv" "the checks against the real clients were skipped" 'dimod==0.12.*' 'dwave-cloud-client[mocks]==0.14.*' \
  'dwave-samplers==1.*' 'dwave-networkx==0.8.*' 'bqpjson==0.5.*'
"$venv/bin/python" tests/interop/ocean.py "$program" .
/usr/bin/python3 tests/interop/files.py "$program"
