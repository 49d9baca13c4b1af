#!/usr/bin/env bash
# Saves every shipped scene in mid-run on 4 nodes over DDS, goes on from the file on 1, 2, 4 and 9, and compares the state
# hash of every later step with that of the run that was never stopped. Then the same in virtual time for random worlds, and
# what it costs to keep one. Prints a table in Markdown, and with no SCENE writes docs/results.md#saved_worlds. About 20
# minutes on 2 cores; goes on where it was stopped.
#   scripts/saved_worlds.sh [--steps N=600] [--seeds N=200] [--domain N=72] [--out DIR=build/saved_worlds] [SCENE ...]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

steps=600 seeds=200 domain=72 out=build/saved_worlds
while [[ ${1:-} == --* ]]; do
  case $1 in
    --steps) steps=$2 ;;
    --seeds) seeds=$2 ;;
    --domain) domain=$2 ;;
    --out) out=$2 ;;
    *) printf 'saved_worlds.sh: %s?\n' "$1" >&2; exit 2 ;;
  esac
  shift 2
done

aurasim=build/release/aurasim
# shellcheck source=scripts/measured.sh
source scripts/measured.sh
# shellcheck source=scripts/scene_regions.sh
source scripts/scene_regions.sh
begin_measuring docs/results.md#saved_worlds "$out" double aurasim-lab aurasim_bench
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

if [[ $# -eq 0 ]]; then
  for network in good bad; do
    build/release/aurasim-lab experiment scenes --seeds "1-$seeds" --save-at 170 --load-on 1,2,4,9 --network "$network" --no-shrink \
      --out "$out/seeds_$network" >/dev/null || failures=$((failures + 1))
    build/release/aurasim-lab experiment scenes --seeds "1-$seeds" --deaths 3 --network "$network" --no-shrink --out "$out/deaths_$network" \
      >/dev/null || failures=$((failures + 1))
  done
  build/release/aurasim_bench --benchmark_filter='_world/' --benchmark_format=json 2>/dev/null >"$out/bench.json"
  /usr/bin/python3 scripts/write_saved_worlds.py "$out" --steps "$steps"
  echo "written: docs/results.md#saved_worlds" >&2
fi
exit $((failures > 0))
