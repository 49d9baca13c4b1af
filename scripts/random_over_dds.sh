#!/usr/bin/env bash
# Runs random worlds (docs/development.md) over real DDS processes, the first seed on 2 nodes, the next on 4, then 9, 2,
# ... and each on one node, and compares the hashes of all states. Prints a line for each; exit 1 if any differs. About 8 s
# a seed on two cores.
#   scripts/random_over_dds.sh [--seeds A-B=1-100] [--steps N=400] [--domain N=71] [--out DIR=build/random_over_dds]
#     [--set KEY=VALUE ...], as for launch; exchange is aura unless it is set
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

seeds=1-100 steps=400 domain=71 out=build/random_over_dds changes=()
while [[ $# -gt 0 ]]; do
  case $1 in
    --seeds) seeds=$2 ;;
    --steps) steps=$2 ;;
    --domain) domain=$2 ;;
    --out) out=$2 ;;
    --set) changes+=(--set "$2") ;;
    *) printf 'random_over_dds.sh: %s?\n' "$1" >&2; exit 2 ;;
  esac
  shift 2
done

aurasim=build/release/aurasim
scripts/build.sh release aurasim aurasim-lab >&2
build/release/aurasim-lab experiment scenes --seeds "$seeds" --steps 1 --keep --out "$out/worlds" >&2

# A world that physics breaks ends with an exit code of its own, and has a report all the same.
run() { # REPORT LAUNCH REGIONS
  "$aurasim" launch "$2" --headless --steps "$steps" --report "$1" --set time.sync=deterministic --set time.pace=none \
    --set "dds.domain=$domain" --set exchange=aura --set "regions=$3" "${changes[@]}" >"$1.log" 2>&1 ||
    [[ -s $1/summary.json ]]
}

failed=0
layouts=('{layout: columns, count: 2, width: 6}' '{layout: grid, rows: 2, columns: 2, cell: [6, 6]}'
  '{layout: grid, rows: 3, columns: 3, cell: [6, 6]}')
nodes=(2 4 9)
for ((seed = ${seeds%-*}, k = 0; seed <= ${seeds#*-}; ++seed, ++k)); do
  world=$out/worlds/seed_$seed/launch.yaml report=$out/seed_$seed
  rm -rf "$report"
  mkdir -p "$report"
  said="does not end: $report/*.log"
  if run "$report/nodes" "$world" "${layouts[k % 3]}" && run "$report/one" "$world" '{layout: columns, count: 1, width: 6}'; then
    said=$("$aurasim" compare "$report/nodes" "$report/one") && equal=yes || equal=no
  else
    equal=no
  fi
  [[ $equal == yes ]] || failed=$((failed + 1))
  echo "seed $seed, ${nodes[k % 3]} nodes: $equal; $said"
done
echo "$failed of $((${seeds#*-} - ${seeds%-*} + 1)) differ"
[[ $failed == 0 ]]
