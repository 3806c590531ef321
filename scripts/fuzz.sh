#!/usr/bin/env bash
# Damages the files of every reader: by number, then under libFuzzer where Clang is there.
#   scripts/fuzz.sh [seconds of libFuzzer for each reader, 120] [mutations of each reader, 10000] [reader...]
# Inputs that libFuzzer finds worth keeping, and crashes, lie in build/cpu-fuzz/corpus/<reader>.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

seconds=${1:-120} count=${2:-10000}
shift $(($# < 2 ? $# : 2))
status=0

configure cpu-release
build cpu-release mutations
if (($# == 0)); then
  mapfile -t readers < <(build/cpu-release/tests/fuzz/mutations --list yes)
else
  readers=("$@")
fi
for reader in "${readers[@]}"; do
  build/cpu-release/tests/fuzz/mutations --count "$count" --reader "$reader" || status=1
done

command -v clang++ >/dev/null || { say "clang++ is not installed: libFuzzer is left out"; exit "$status"; }
configure cpu-fuzz
build cpu-fuzz fuzz_readers
fuzzer=build/cpu-fuzz/tests/fuzz/fuzz_readers
known=$("$fuzzer")
(($# == 0)) && mapfile -t readers <<<"$known"
for reader in "${readers[@]}"; do
  grep -qx "$reader" <<<"$known" || continue  # readers that take simulations or maps: mutations alone
  corpus=build/cpu-fuzz/corpus/$reader
  mkdir -p "$corpus"
  say "libFuzzer on $reader for $seconds s"
  # GDAL and its libraries keep what they read, so that leaks at the end are theirs.
  GONOGO_READER=$reader GONOGO_SEED_FILE=$corpus/whole ASAN_OPTIONS=detect_leaks=0 \
    "$fuzzer" "$corpus" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=4096 \
    -max_len=65536 -artifact_prefix="$corpus/" -print_final_stats=1 -verbosity=0 -print_funcs=0 || status=1
done
exit "$status"
