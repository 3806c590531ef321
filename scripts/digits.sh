#!/usr/bin/env bash
# Density and label accuracy on handwritten digits beside scikit-learn, which PyPI brings into a throw-away environment.
#   cmake --build build/cpu-release --target learning_digits && scripts/digits.sh [learning_digits]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
program=${1:-build/cpu-release/tests/learning/learning_digits}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install --quiet 'scikit-learn==1.*'
"$work/venv/bin/python" scripts/digits.py "$program" "$work/data"
