#!/usr/bin/env bash
# A picture and a short video of every scene of many bodies, and the curves of those that tell something over time:
#   scripts/scenes_gallery.sh [<gonogo>] [<folder, out/scenes>] [<scene>...]
# Small sizes: about a quarter of an hour on one core, most of it the tracked vehicle. SCALE=20 makes every scene so many times
# as large (but the vehicle's, whose floor only grows), OPTIONS="--backend cuda" goes to every command. With PUBLISH=1 the
# pictures are reduced and put into docs/images/scenes. Needs ffmpeg; PUBLISH needs ImageMagick's convert.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/common.sh

gonogo=${1:-build/cpu-release/gonogo}
out=${2:-out/scenes}
shift $(($# < 2 ? $# : 2))
scenes=("$@")
[ ${#scenes[@]} -gt 0 ] || scenes=(tank silo drum screen pebbles nut ball crater collapse)
scale=${SCALE:-1}
read -r -a more <<< "${OPTIONS:-}"
mkdir -p "$out"

# What a scene is made with: spheres, then its options.
made_with() {
  case $1 in
    tank) echo "$((2000 * scale)) --every 0.02" ;;
    silo) echo "$((1000 * scale)) --slenderness 2 --flow-time 1 --every 0.2 --plot $out/silo_stress.png" ;;
    drum) echo "$((1500 * scale)) --turns 2 --every 0.2 --plot $out/drum_mixing.png" ;;
    screen) echo "$((1500 * scale)) --seconds 8 --every 0.1 --plot $out/screen_sorting.png" ;;
    pebbles) echo "$((7000 * scale)) --layers 3 --seconds 2.5 --speed 2 --iterations 30 --every 0.05 --plot $out/pebbles_drive.png" ;;
    nut) echo "$((600 * scale)) --seconds 6 --every 0.2" ;;
    ball) echo "$((2000 * scale)) --ball 6 --seconds 1.5 --every 0.1" ;;
    crater) echo "$((3000 * scale)) --height 1.6 --every 0.04" ;;
    collapse) echo "$((1500 * scale)) --aspect 1 --every 0.1" ;;
    *) say "scenes_gallery: no scene is called $1"; exit 2 ;;
  esac
}

for scene in "${scenes[@]}"; do
  read -r -a options <<< "$(made_with "$scene")"
  say "$scene: ${options[*]}"
  "$gonogo" bench "$scene" --spheres "${options[@]}" --repeats 3 --picture "$out/$scene.png" --video "$out/$scene.mp4" \
    "${more[@]}" --json | tail -1 > "$out/$scene.json"
done

if [ "${PUBLISH:-0}" = 1 ]; then
  mkdir -p docs/images/scenes
  for picture in "$out"/*.png; do
    convert "$picture" -resize 800x -colors 128 PNG8:"docs/images/scenes/$(basename "$picture")"
  done
fi
