#!/usr/bin/env bash
# Formats all C++ and CUDA sources that git tracks by .clang-format; with --check it changes nothing and fails when a file
# differs. Only clang-format 14 counts, since versions differ in details: the package clang-format-14 of Debian 12 and
# Ubuntu 24.04, or clang-format==14.0.6 of PyPI.
#   scripts/format.sh [--check]
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

version=14
check=false
case ${1:-} in
  '') ;;
  --check) check=true ;;
  *) fail "no option '$1'; there is --check" ;;
esac

formatter=
for name in clang-format-$version clang-format; do
  if command -v "$name" >/dev/null && [[ $("$name" --version) =~ version\ $version\. ]]; then
    formatter=$name
    break
  fi
done
[[ -n $formatter ]] || fail "needs clang-format $version: apt-get install clang-format-$version, or pip install clang-format==14.0.6"

mapfile -t files < <(git ls-files '*.h' '*.cpp' '*.cu' '*.cuh')
((${#files[@]} > 0)) || fail "git tracks no sources here"
if ! $check; then
  "$formatter" -i "${files[@]}"
  say "formatted ${#files[@]} files"
  exit
fi

if ! report=$("$formatter" --dry-run -Werror "${files[@]}" 2>&1); then
  mapfile -t differing < <(sed -n 's/^\([^:]*\):[0-9]*:[0-9]*: error: code should be clang-formatted.*/\1/p' <<< "$report" | sort -u)
  ((${#differing[@]} > 0)) || fail "$formatter failed: $report"
  printf '%s\n' "${differing[@]}"
  fail "${#differing[@]} of ${#files[@]} files are not formatted; scripts/format.sh does it"
fi
say "all ${#files[@]} sources are formatted"
