#!/usr/bin/env bash
# Runs shipped scenes in deterministic mode over real DDS processes on 1, 2, 4 and 9 nodes, twice, on a good network and
# on a bad one (16 ms delay, 5 ms jitter, 10% loss on every datagram), and compares the state hash of every step with
# the run on one node. Prints a table in Markdown; exit 1 if anything differs. Takes about two hours for everything, a good
# hour for one network; goes on where it was stopped, as long as DIR is there.
#   scripts/same_bits.sh [--steps N=1800] [--repetitions N=1] [--network good|bad|both] [--domain N=70]
#                        [--out DIR=build/same_bits] [--set KEY=VALUE ...] [SCENE ...]
# Regions meet by auras unless another `exchange` is set; measure that into another DIR.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

steps=1800 repetitions=1 network=both domain=70 out=build/same_bits changes=(--set exchange=aura)
while [[ ${1:-} == --* ]]; do
  case $1 in
    --steps) steps=$2 ;;
    --repetitions) repetitions=$2 ;;
    --network) network=$2 ;;
    --domain) domain=$2 ;;
    --out) out=$2 ;;
    --set) changes+=(--set "$2") ;;
    *) printf 'same_bits.sh: %s?\n' "$1" >&2; exit 2 ;;
  esac
  shift 2
done

aurasim=${AURASIM:-build/release/aurasim}
[[ -n ${AURASIM_SKIP_BUILD:-} ]] || scripts/build.sh release aurasim >&2
mkdir -p "$out"
reports=$(mktemp -d)
trap 'rm -rf "$reports"' EXIT

# shellcheck source=scripts/scene_regions.sh
source scripts/scene_regions.sh

run() {
  local report=$1 scene=$2 nodes=$3
  shift 3
  "$aurasim" launch "launch_configs/$scene.yaml" --headless --steps "$steps" --report "$report" \
    --set time.sync=deterministic --set time.pace=none --set "dds.domain=$domain" --set "$(regions_of "$scene" "$nodes")" "${changes[@]}" "$@" \
    >"$report.log" 2>&1
}

# A number, or how many there are.
field() {
  python3 -c 'import json, sys; f = json.load(open(sys.argv[1]))[sys.argv[2]]; print(len(f) if isinstance(f, list) else f)' "$1" "$2"
}

bad=(--set dds.impair.delay=0.016 --set dds.impair.jitter=0.005 --set dds.impair.loss=0.1)
failures=0
row() {
  local scene=$1 nodes=$2 on=$3 again=$4
  shift 4
  local report=$reports/other verdict cells
  cells="| $scene | $nodes | $on | $again |"
  rm -rf "$report"
  if ! run "$report" "$scene" "$nodes" "$@"; then
    verdict="the run failed: $(tail -n 1 "$report.log")"
  elif verdict=$("$aurasim" compare "$reports/central" "$report"); then
    verdict="equal, $(field "$report/summary.json" steps) steps"
  fi
  cells+=" $(field "$report/summary.json" migrations 2>/dev/null || echo -) |"
  cells+=" $(field "$report/summary.json" redos 2>/dev/null || echo -) | $verdict |"
  [[ $verdict == equal* ]] || failures=$((failures + 1))
  echo "$cells" | tee -a "$out/$on-$steps.md"
}

# The rows that are still to be measured for a scene: NODES NETWORK REPETITION. Those that are there are printed.
missing_rows() {
  local scene=$1 nodes on again
  for ((again = 1; again <= repetitions; ++again)); do
    for nodes in 2 4 9; do
      for on in good bad; do
        [[ $network == both || $network == "$on" ]] || continue
        grep -s "^| $scene | $nodes | $on | $again |.*| equal" "$out/$on-$steps.md" >&2 || echo "$nodes $on $again"
      done
    done
  done
}

scenes=("$@")
[[ ${#scenes[@]} -gt 0 ]] || mapfile -t scenes < <(printf '%s\n' "${!cell[@]}" | sort)
printf '| scene | nodes | network | repetition | hand-offs | redos | against one node |\n|---|---|---|---|---|---|---|\n'
for scene in "${scenes[@]}"; do
  mapfile -t rows < <(missing_rows "$scene")
  [[ ${#rows[@]} -gt 0 ]] || continue
  rm -rf "$reports/central"
  run "$reports/central" "$scene" 1 || { cat "$reports/central.log" >&2; exit 1; }
  for row in "${rows[@]}"; do
    read -r nodes on again <<<"$row"
    if [[ $on == good ]]; then row "$scene" "$nodes" good "$again"; else row "$scene" "$nodes" bad "$again" "${bad[@]}"; fi
  done
done
exit $((failures > 0))
