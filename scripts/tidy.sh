#!/usr/bin/env bash
# clang-tidy 14 with the checks of .clang-tidy over all sources, or over those named. Fails when there is a finding.
#   scripts/tidy.sh [source files...]
# Without LibTorch, whose headers Clang 14 cannot read as C++20, and without CUDA. Debian 12 counts: scripts/setup.sh --clang
# installs clang-tidy 14 and the omp.h that goes with it.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

version=14
folder=build/tidy
tidy=
for name in clang-tidy-$version clang-tidy; do
  if command -v "$name" >/dev/null && [[ $("$name" --version) =~ version\ $version\. ]]; then
    tidy=$name
    break
  fi
done
[[ -n $tidy ]] || fail "needs clang-tidy $version: scripts/setup.sh --clang"

configure cpu-debug -B "$folder" -DGONOGO_TORCH=OFF -DGONOGO_BROWSER_TESTS=OFF > /dev/null
files=("$@")
if ((${#files[@]} == 0)); then
  mapfile -t files < <(sed -n "s|^ *\"file\": \"$PWD/\(.*\)\"$|\1|p" "$folder/compile_commands.json" | grep -v '^build/' | sort -u)
fi
((${#files[@]} > 0)) || fail "$folder/compile_commands.json names no source"
say "clang-tidy over ${#files[@]} sources"
# GCC's own warning options are in the compile commands.
printf '%s\0' "${files[@]}" |
  xargs -0 -P "$(nproc)" -n 4 "$tidy" -p "$folder" --quiet --extra-arg=-Wno-unknown-warning-option ||
  fail "clang-tidy found something"
say "clang-tidy found nothing"
