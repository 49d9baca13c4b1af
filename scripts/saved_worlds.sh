#!/usr/bin/env bash
# Saves every shipped scene in mid-run on 4 nodes over DDS, goes on from the file on 1, 2, 4 and 9, and compares the state
# hash of every later step with that of the run that was never stopped. Prints a table in Markdown; exit 1 if anything
# differs. About 15 minutes on 2 cores; goes on where it was stopped, as long as DIR is there.
#   scripts/saved_worlds.sh [--steps N=600] [--domain N=72] [--out DIR=build/saved_worlds] [SCENE ...]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

steps=600 domain=72 out=build/saved_worlds
while [[ ${1:-} == --* ]]; do
  case $1 in
    --steps) steps=$2 ;;
    --domain) domain=$2 ;;
    --out) out=$2 ;;
    *) printf 'saved_worlds.sh: %s?\n' "$1" >&2; exit 2 ;;
  esac
  shift 2
done

aurasim=${AURASIM:-build/release/aurasim}
# shellcheck source=scripts/scene_regions.sh
source scripts/scene_regions.sh
[[ -n ${AURASIM_SKIP_BUILD:-} ]] || scripts/build.sh release aurasim >&2
mkdir -p "$out"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

run() { # REPORT SCENE NODES [OPTION ...]
  local report=$1 scene=$2 nodes=$3
  shift 3
  "$aurasim" launch "launch_configs/$scene.yaml" --headless --steps "$steps" --report "$report" --saves "$work/saves" \
    --set time.sync=deterministic --set time.pace=none --set "dds.domain=$domain" \
    --set "$(regions_of "$scene" "$nodes")" "$@" >"$report.log" 2>&1
}

# SCENE: one row of the table, once.
row() {
  local scene=$1 hz world nodes verdict cells info
  ! grep -qs "^| $scene |.*equal" "$out/scenes.md" || return 0
  rm -rf "$work"/*
  hz=$(sed -nE 's/^ *step_hz: *([0-9.]+).*/\1/p' "launch_configs/$scene.yaml")
  run "$work/whole" "$scene" 4 --save-every "$(awk -v n="$steps" -v hz="${hz:-60}" 'BEGIN { print n / 2 / hz }')" ||
    { cat "$work/whole.log" >&2; exit 1; }
  world=$(find "$work/saves" -name 'state-*-of-4' | sort -V | head -n 1)
  "$aurasim" cut merge "$work/world.cut" "${world%.part-*}".part-*
  info=$("$aurasim" cut info "$work/world.cut")
  cells="| $scene | $(jq -r .step <<<"$info") | $(jq -r .bodies <<<"$info") | $(jq -r .bodies_under_way <<<"$info") |"
  cells+=" $(jq -r .contact_points <<<"$info") | $(stat -c %s "$work/world.cut") |"
  for nodes in 1 2 4 9; do
    rm -rf "$work/again"
    if ! run "$work/again" "$scene" "$nodes" --load "$work/world.cut"; then
      verdict="failed: $(tail -n 1 "$work/again.log")"
    elif verdict=$("$aurasim" compare "$work/whole" "$work/again"); then
      verdict="equal"
    fi
    [[ $verdict == equal ]] || failures=$((failures + 1))
    cells+=" $verdict |"
  done
  echo "$cells" | tee -a "$out/scenes.md"
}

failures=0
scenes=("$@")
[[ ${#scenes[@]} -gt 0 ]] || mapfile -t scenes < <(printf '%s\n' "${!cell[@]}" | sort)
printf '| scene | state | bodies | under way | contact points | bytes | 1 node | 2 | 4 | 9 |\n|---|---|---|---|---|---|---|---|---|---|\n'
for scene in "${scenes[@]}"; do row "$scene"; done

exit $((failures > 0))
