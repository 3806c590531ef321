#!/usr/bin/env bash
# From a fresh machine to the Go/NoGo map of the sample region: installs what is missing, builds, simulates, learns, maps.
#   scripts/demo.sh
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

out=out/demo
start=$SECONDS
scripts/setup.sh --no-browser
options=()
# A folder that is configured keeps what it builds.
[[ -e build/cpu-release/CMakeCache.txt ]] || options=(-DGONOGO_LAB=OFF -DGONOGO_TESTS=OFF)
configure cpu-release "${options[@]}"
build cpu-release gonogo
built=$SECONDS
say "running the main job: gonogo run configs/studies/demo.json --out $out"
build/cpu-release/gonogo run configs/studies/demo.json --out "$out"
say "the map is in $out/map:"
find "$out/map" -maxdepth 1 -type f | sort
say "set-up and build took $((built - start)) s, the run $((SECONDS - built)) s"
