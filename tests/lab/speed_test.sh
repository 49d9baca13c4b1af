#!/usr/bin/env bash
# speed_test.sh LABORATORY: `experiment speed` of every case in small, and the rows of its times and errors.
set -euo pipefail
lab=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "FAILED: $*" >&2; exit 1; }

"$lab" experiment speed --quick --settings sequential_impulse,fast --out "$work" >/dev/null 2>&1
[[ $(tail -n +2 "$work/runs.csv" | cut -d, -f1 | sort -u | tr '\n' ' ') == "card_houses gas hulls pyramid ragdolls rain sleepers " ]] ||
  fail "runs.csv does not have every scene"
[[ $(wc -l <"$work/runs.csv") == 15 ]] || fail "runs.csv does not have seven scenes by two settings"
"$lab" experiment speed-errors --out "$work" --results "$work/results"
rows=$work/results/speed.jsonl

expect() { # WHAT SCENE METRIC CONDITION: it holds with both settings
  jq -s -e --arg scene "$2/" --arg metric "$3" \
    "[.[] | select((.case | startswith(\$scene)) and .metric == \$metric) | .value] | length == 2 and all($4)" "$rows" >/dev/null ||
    fail "$1: $(grep "\"$2/" "$rows")"
}
expect "EveryRunIsTimed" gas CPU '. > 0'
expect "NothingIsLost" rain lost '. == 0'
expect "ThePyramidStands" pyramid fallen '. == 0'
expect "ThePyramidDoesNotSink" pyramid 'most sunk' '. < 10'
expect "HullsDoNotOverlapByMoreThanCentimetres" hulls 'deepest overlap' '. < 50'
expect "NoHullIsLost" hulls lost '. == 0'
expect "RagdollsHoldTogether" ragdolls 'widest joint gap' '. < 50'
expect "HingesDoNotBend" ragdolls 'hinge off axis or limits' '. < 0.2'
expect "CardHousesStand" card_houses fallen '. == 0'
expect "SleepersStayWhereTheyAre" sleepers 'farthest drift' '. < 0.01'
expect "SleepersDoNotSink" sleepers 'most sunk' '. < 10'
# In so short a run the energy scatters by 0.2% with the order of the bits.
expect "GasKeepsItsEnergy" gas 'energy gained' '. < 0.3 and . > -0.3'
expect "NoGasIsLost" gas lost '. == 0'
