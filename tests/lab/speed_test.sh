#!/usr/bin/env bash
# speed_test.sh LABORATORY: `experiment speed` of every case in small, the errors of what it leaves, and the rows of both.
# shellcheck disable=SC2016 # columns of awk
set -euo pipefail
lab=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "FAILED: $*" >&2; exit 1; }

"$lab" experiment speed --quick --settings sequential_impulse,fast --out "$work" >/dev/null 2>&1
"$lab" experiment speed-errors --out "$work"
for table in runs errors; do
  [[ $(tail -n +2 "$work/$table.csv" | cut -d, -f1 | sort -u | tr '\n' ' ') == "card_houses gas hulls pyramid ragdolls rain sleepers " ]] ||
    fail "$table.csv does not have every scene"
  [[ $(wc -l <"$work/$table.csv") == 15 ]] || fail "$table.csv does not have seven scenes by two settings"
done

# errors.csv: scene,engine,precision,threads,overlap_m,in_static_m,drift_m,sunk_m,fallen,lost,energy,joint_gap_m,hinge_turn_rad
expect() { # WHAT SCENE CONDITION
  awk -F, -v scene="$2" "\$1 == scene { ++seen; if (!($3)) wrong = 1 } END { exit wrong || seen != 2 }" "$work/errors.csv" ||
    fail "$1: $(grep "^$2," "$work/errors.csv")"
}
expect "NothingIsLost" rain '$10 == 0'
expect "ThePyramidStands" pyramid '$9 == 0 && $8 < 0.01'
expect "HullsDoNotOverlapByMoreThanCentimetres" hulls '$5 < 0.05 && $10 == 0'
expect "RagdollsHoldTogether" ragdolls '$12 < 0.05 && $13 < 0.2'
expect "CardHousesStand" card_houses '$9 == 0'
expect "SleepersStayWhereTheyAre" sleepers '$7 < 0.01 && $8 < 0.01'
expect "GasKeepsItsEnergy" gas '$11 < 1e-3 && $11 > -1e-3 && $10 == 0'

"$lab" experiment speed-errors --out "$work" --results "$work/results"
for row in '"case":"gas/aurasim-fast, double","metric":"CPU"' '"case":"ragdolls/aurasim-sequential_impulse, double","metric":"widest joint gap"'; do
  [[ $(grep -cF "$row" "$work/results/speed.jsonl") == 1 ]] || fail "speed.jsonl does not have $row once"
done
