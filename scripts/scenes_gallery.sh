#!/usr/bin/env bash
# A picture and a short video of every scene of many bodies, and the curves of those that tell something over time:
#   scripts/scenes_gallery.sh [<gonogo>] [<folder, out/scenes>] [<scene>...]
# Small sizes: about ten minutes on one core, most of them the tracked vehicle. SCALE=20 makes every scene so many times
# as large (but the vehicle's, whose floor only grows), OPTIONS="--backend cuda" goes to every command. With PUBLISH=1 the
# pictures are reduced and put into docs/images/scenes. Needs ffmpeg.
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
    tank) echo "$((2000 * scale)) --seconds 1.5 --every 0.02" ;;
    silo) echo "$((1500 * scale)) --slenderness 1.6 --orifice 6 --flow-time 0.5 --every 0.05 --plot $out/silo_stress.png" ;;
    drum) echo "$((600 * scale)) --turns 2 --iterations 30 --every 0.1 --plot $out/drum_mixing.png" ;;
    screen) echo "$((800 * scale)) --seconds 4 --every 0.05 --plot $out/screen_sorting.png" ;;
    pebbles) echo "$((7000 * scale)) --layers 3 --seconds 2.5 --speed 2 --iterations 30 --every 0.05 --plot $out/pebbles_drive.png" ;;
    nut) echo "$((500 * scale)) --seconds 5 --iterations 25 --every 0.1" ;;
    ball) echo "$((1500 * scale)) --ball 6 --seconds 1 --iterations 30 --every 0.0125" ;;
    crater) echo "$((2000 * scale)) --height 1.6 --iterations 30 --every 0.01" ;;
    collapse) echo "$((1500 * scale)) --aspect 1 --every 0.02" ;;
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
    ffmpeg -loglevel error -y -i "$picture" -vf \
      "scale=800:-1:flags=lanczos,split[a][b];[a]palettegen=max_colors=96[p];[b][p]paletteuse=dither=none" \
      "docs/images/scenes/$(basename "$picture")"
  done
fi
