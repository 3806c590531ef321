#!/usr/bin/env bash
# Makes PNG files small enough for the tree, at most 250 kB each, in place:
#   scripts/shrink_pictures.sh docs/images/page.png docs/gallery/*.png
# Pictures wider than 1280 pixels are scaled to 1200. Colours come from a palette of 256, or fewer until the file fits.
# A file that fits already is left alone. Needs ffmpeg and pngquant.
set -euo pipefail

limit=250000 # [bytes]

size_of() { stat -c %s "$1"; }

for picture in "$@"; do
  before=$(size_of "$picture")
  [ "$before" -gt "$limit" ] || continue
  small=$(mktemp --suffix .png)
  ffmpeg -loglevel error -y -i "$picture" -vf "scale='if(gt(iw,1280),1200,iw)':-1:flags=lanczos" "$small"
  for colours in 256 192 128 96 64 32; do
    pngquant --force --nofs --speed 1 --output "$small.quantised" "$colours" "$small"
    [ "$(size_of "$small.quantised")" -gt "$limit" ] || break
  done
  if [ "$(size_of "$small.quantised")" -gt "$limit" ]; then
    echo "$picture: over $limit bytes with 32 colours; make it narrower" >&2
    exit 1
  fi
  cat "$small.quantised" > "$picture"
  rm "$small" "$small.quantised"
  echo "$picture: $before to $(size_of "$picture") bytes"
done
