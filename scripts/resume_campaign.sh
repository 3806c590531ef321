#!/usr/bin/env bash
# Continues the campaign that is packed in a data folder, and packs it again. All trials of a campaign come from one program,
# so this builds the revision that computed the first ones.
#
#   scripts/resume_campaign.sh DATA build                     # the program only: needs nvcc and the history, no GPU
#   scripts/resume_campaign.sh DATA run [seconds] [places] [workers] [options of gonogo campaign run...]
#                                                             # unpacks, computes on all GPUs of this machine, packs
#   scripts/resume_campaign.sh DATA status                    # unpacks and says how far it is
#   scripts/resume_campaign.sh DATA pack                      # may be called while it runs; also writes DATA/dataset.h5
#
# DATA is data/hmmwv_32mm, say: its study is configs/studies/hmmwv_32mm.json as it was when the campaign was last packed,
# its folder out/hmmwv_32mm. `build` leaves the program, the libraries that it needs, and the vehicles and soils of its
# revision in build/program-REVISION; copy that folder to a machine without history.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"
usage() { sed -n '2,/^set /{/^#/s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}"; exit 2; }
[[ $# -ge 2 ]] || usage
data=${1%/} action=$2 seconds=${3:-480} places=${4:-48}
name=$(basename "$data")
folder=out/$name archive=$data/campaign.tar.gz
[[ -f $archive ]] || fail "$archive: no such file; name a data folder that holds a packed campaign"

# "0.1.0 (f79d486fa5a0)" in campaign.json
revision=$(tar -xzOf "$archive" "$name/campaign.json" | sed -n 's/.*"program": "[^(]*(\([^)]*\))".*/\1/p')
[[ -n $revision ]] || fail "$archive: its campaign.json does not name the program"
program=$PWD/build/program-$revision
export LD_LIBRARY_PATH=$program/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}

# Libraries beyond those of the C and C++ compilers, which every machine has.
needed_libraries() { ldd "$1" | awk '$2 == "=>" && $3 ~ /^\// {print $3}' | grep -Ev '/lib(c|m|dl|rt|pthread|resolv|stdc\+\+|gcc_s)\.so'; }

build_program() {
  [[ ! -x $program/gonogo ]] || return 0
  git cat-file -e "$revision^{commit}" 2> /dev/null ||
    fail "this copy has no history: run '$0 $data build' in a clone and copy build/program-$revision here"
  local source_tree=$PWD/build/source-$revision
  local built=$source_tree/build/cuda-release/gonogo
  say "building the program of revision $revision"
  mkdir -p "$source_tree" "$program/lib"
  git archive "$revision" | tar -x -C "$source_tree"
  # Without the ceiling the build would find this repository, and name its revision instead.
  (export GONOGO_REVISION=$revision GIT_CEILING_DIRECTORIES=$PWD/build && cd "$source_tree" && build_gpu_program)
  cp -r "$source_tree/configs" "$program/"
  # Studies as they were when the campaign was last packed: some were written after the program of their trials.
  local packed
  packed=$(git log -1 --format=%H -- "$archive")
  git ls-tree -d --name-only "$packed" configs/studies configs/families | xargs git archive "$packed" | tar -x -C "$program"
  needed_libraries "$built" | xargs -I{} cp -L {} "$program/lib/"
  cp "$built" "$program/gonogo.new" && strip "$program/gonogo.new" && mv "$program/gonogo.new" "$program/gonogo"
}

# Any build of the program reads a campaign; only `run` needs the one that computed it.
any_program() {
  local one
  for one in "$program/gonogo" build/cuda-release/gonogo build/cpu-release/gonogo; do
    [[ ! -x $one ]] || { echo "$one"; return 0; }
  done
  fail "build the program first: scripts/setup.sh, or '$0 $data build'"
}

unpack() {
  [[ ! -d $folder ]] || return 0
  mkdir -p out
  tar -xzf "$archive" -C out
}

# From a copy, since a campaign that runs appends to its journal meanwhile: a line cut short is computed again.
pack() {
  local gonogo copy part
  gonogo=$(any_program)
  [[ -f $folder/campaign.json ]] || fail "$folder: holds no campaign; '$0 $data status' unpacks it"
  copy=$(mktemp -d)
  mkdir "$copy/$name"
  for part in campaign.json origin.h5 shards trials courses; do
    [[ ! -e $folder/$part ]] || cp -r "$folder/$part" "$copy/$name/"
  done
  tar -C "$copy" --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner -cf - "$name" | gzip -9n > "$archive.new"
  if [[ -e $copy/$name/origin.h5 ]] || compgen -G "$copy/$name/shards/*.json" > /dev/null; then
    "$gonogo" campaign snapshot "$copy/$name" --out "$data/dataset.h5"
  else
    say "no dataset yet: the first shard of this campaign of an older program is not whole"
  fi
  "$gonogo" campaign status "$copy/$name"
  mv "$archive.new" "$archive"
  rm -r "$copy"
}

case $action in
  build) build_program ;;
  status)
    gonogo=$(any_program)
    unpack
    "$gonogo" campaign status "$folder"
    ;;
  pack) pack ;;
  run)
    build_program
    unpack
    # Study as the campaign was packed, vehicles and soils of its revision.
    GONOGO_PROGRAM=$program/gonogo scripts/gpu_campaign.sh "$program/configs/studies/$name.json" "$folder" "$seconds" \
      "$places" "${@:5}"
    pack
    ;;
  *) usage ;;
esac
