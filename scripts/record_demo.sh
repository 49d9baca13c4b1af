#!/usr/bin/env bash
# The moving picture of the README: runs the demo, records it, and has a browser without a screen draw every frame of the
# recording, so that a slow machine makes the same picture as a fast one. Needs a release build, chromium, and ffmpeg
# (apt-get install ffmpeg); a few minutes without a graphics card.
#   scripts/record_demo.sh [PICTURE=docs/demo.webp] [LAUNCH=launch_configs/demo.yaml]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

picture=${1:-docs/demo.webp}
launch=${2:-launch_configs/demo.yaml}
# In steps of 1/60 s: where it begins, how far apart the pictures are, how many; shown so many times a second.
first=270 apart=3 count=140 per_second=20
aurasim=${AURASIM:-build/release/aurasim}
command -v ffmpeg >/dev/null || { echo "record_demo.sh: needs ffmpeg: apt-get install ffmpeg" >&2; exit 1; }
[[ -x $aurasim ]] || scripts/build.sh release aurasim
scripts/build_web.sh --tests

work=$(mktemp -d)
replay=
finish() {
  [[ -z $replay ]] || kill "$replay" 2>/dev/null || true
  rm -rf "$work"
}
trap finish EXIT

"$aurasim" launch "$launch" --steps $((first + apart * count + 60)) --record "$work/demo.rec" --set overseer.port=0 \
  >"$work/launch.log" 2>&1 || { tail "$work/launch.log" >&2; exit 1; }
"$aurasim" replay "$work/demo.rec" --port 0 >"$work/replay.log" 2>&1 &
replay=$!
until url=$(grep -o 'http://127.0.0.1:[0-9]*/' "$work/replay.log"); do
  kill -0 "$replay" || { cat "$work/replay.log" >&2; exit 1; }
  sleep 0.1
done
node tests/web/record_demo.mjs "$url" "$work" "$first" "$apart" "$count"
ffmpeg -hide_banner -loglevel error -y -framerate "$per_second" -i "$work/%03d.png" \
  -c:v libwebp_anim -loop 0 -quality 60 -compression_level 6 "$picture"
echo "$picture: $(stat --format=%s "$picture") bytes"
