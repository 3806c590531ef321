#!/usr/bin/env bash
# The installed package as its users meet it: installs into an empty prefix, builds examples/ against that prefix alone,
# and runs them on what the demo left. Needs a build of cpu-release and scripts/demo.sh.
#   scripts/check_package.sh
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

demo=$PWD/out/demo
[[ -s $demo/dataset.h5 && -s $demo/model.h5 ]] || fail "no trials and model in out/demo: run scripts/demo.sh first"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
prefix=$scratch/prefix examples=$scratch/examples
say "installing into an empty prefix"
cmake --install build/cpu-release --prefix "$prefix" > "$scratch/install.log"
# Exactly the public headers, and no folder of others in what targets export.
diff <(cd include/gonogo && ls) <(cd "$prefix/include/gonogo" && find . -mindepth 1 | sed 's|^\./||' | sort) ||
  fail "the installed headers are not those of include/gonogo"
[[ $(find "$prefix/include" -type f | wc -l) -eq $(find include/gonogo -name '*.h' | wc -l) ]] || fail "other headers were installed, too"
grep -h INTERFACE_INCLUDE_DIRECTORIES "$prefix"/lib*/cmake/gonogo/*.cmake | grep -v '"${_IMPORT_PREFIX}/include"' &&
  fail "a target of the package exports another include folder"
say "building examples/ against it"
arguments=("-DCMAKE_PREFIX_PATH=$prefix" -DCMAKE_BUILD_TYPE=Release)
[[ ! -s .cache/torch_prefix ]] || arguments=("-DCMAKE_PREFIX_PATH=$prefix;$(cat .cache/torch_prefix)" -DCMAKE_BUILD_TYPE=Release)
cmake -S examples -B "$examples" -G Ninja "${arguments[@]}" > "$scratch/configure.log" || { cat "$scratch/configure.log"; fail "examples cannot be configured"; }
cmake --build "$examples" -j "$(build_jobs)" > "$scratch/build.log" || { tail -30 "$scratch/build.log"; fail "examples cannot be built"; }

# Each component links only what it needs.
must_not_link() {
  if ldd "$examples/$1" | grep -E "$2"; then fail "$1 links a library that it must not need"; fi
}
must_not_link settle_and_drive 'gdal|torch|cairo'
must_not_link map_raster 'torch'
cd "$scratch"  # nothing of the source tree may be found by accident
share=$prefix/share/gonogo/configs
say "running them"
export GONOGO_SHARE=$prefix/share/gonogo
"$examples/settle_and_drive" hmmwv_quarter frames > drive.txt
tail -n 1 drive.txt
[[ $(find frames -name 'contacts_*.vtp' | wc -l) -eq 25 ]] || fail "settle_and_drive left no 25 frames"
awk '/ m  torque/ {travelled = $3} END {exit !(travelled > 0.5)}' drive.txt || fail "the wheel of settle_and_drive did not drive"
"$examples/train_and_anneal" "$demo/dataset.h5" annealed > anneal.txt
grep -q '^2000 reads' anneal.txt || fail "train_and_anneal read no answer back"
"$examples/map_raster" hmmwv "$share/regions/sagehen/elevation_10m.tif" "sandy loam" map > map.txt
[[ -s map/go.tif && -s map/index.html ]] || fail "map_raster left no map"
head -n 1 map.txt
"$prefix/bin/gonogo" vehicle show hmmwv > /dev/null || fail "the installed program does not find its vehicles"
say "the package installs, and its examples run"
