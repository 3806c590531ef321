#!/usr/bin/env bash
# Installs what is missing, builds everything and runs every test; fails when one fails, is missing or was skipped.
#   scripts/test.sh [cmake arguments...]      -DGONOGO_WERROR=ON: warnings are errors
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

folder=build/cpu-release
report=$PWD/$folder/tests.xml

# Value of an attribute of the report's first element, <testsuite ... name="3" ...>.
from_report() { sed -n "0,/<testcase/s/^.*[[:space:]]$1=\"\([0-9]*\)\".*$/\1/p" "$report" | head -n 1; }

scripts/setup.sh --tests
browser_tests=ON
if [[ -e .cache/no_browser ]]; then
  browser_tests=OFF
  say "the page is not tested: no package of Chromium on this system"
fi
python=(-DGONOGO_PYTHON=ON "-DPython_EXECUTABLE=$PWD/.cache/python/bin/python")
if [[ -e .cache/no_python ]]; then
  [[ -z ${GONOGO_REQUIRE_INTEROP:-} ]] || fail "the Python module cannot be tested without the packages of PyPI"
  python=(-DGONOGO_PYTHON=OFF)
  say "the Python module is not tested: PyPI cannot be reached"
fi
configure cpu-release "${python[@]}" -DGONOGO_BROWSER_TESTS=$browser_tests -DGONOGO_LAB=ON -DGONOGO_TESTS=ON -DGONOGO_TORCH=ON -DGONOGO_GDAL=ON -DGONOGO_MPI=ON "$@"
build cpu-release
registered=$(ctest --test-dir "$folder" -N | sed -n 's/^Total Tests: //p')
((registered > 0)) || fail "no test is registered"
say "running $registered tests"
rm -f "$report"
status=0
ctest --test-dir "$folder" -j "$(nproc)" --output-on-failure --output-junit "$report" || status=$?

run=$(from_report tests) failed=$(from_report failures) skipped=$(from_report skipped) disabled=$(from_report disabled)
passed=$((run - failed - skipped - disabled))
say "$passed of $registered registered tests passed ($disabled disabled)"
((status == 0)) || fail "tests failed (ctest exit status $status)"
((passed == registered)) || fail "$((registered - passed)) registered tests did not run"
interop=0
scripts/interop.sh "$folder/gonogo" || interop=$?
((interop == 0 || interop == 77)) || fail "the checks against the real clients failed"
((interop == 0)) || [[ -z ${GONOGO_REQUIRE_INTEROP:-} ]] || fail "the checks against the real clients did not run"
printf '%d passed, %d failed, %d skipped\n' "$passed" "$failed" "$skipped"
