#!/usr/bin/env bash
# The stability and pareto experiments in both precisions, side by side, their figures, and docs/accuracy.md.
#   scripts/accuracy.sh [DIR]      DIR: results (build/accuracy); about 8 minutes on 2 cores
# AURASIM_QUICK=1: two steps instead of four, no presets but for the standing piles, and fewer points.
# Fails, after writing everything, when a requirement is not met.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

out=${1:-build/accuracy}
bin=build/release
# shellcheck source=scripts/measured.sh
source scripts/measured.sh
begin_measuring docs/accuracy.md "$out" "double and single"

stability=()
pareto=()
if [[ ${AURASIM_QUICK:-0} == 1 ]]; then
  stability=(--step-hz 60,240 --no-presets)
  pareto=(--simulated 2 --substeps 1,4,8 --iterations 10,50)
fi

# 1: done, but not every requirement is met
both_experiments() {
  local program=$1 precision=$2 met=0
  rm -f "$out"/{stability,pareto}-"$precision"/summary.json
  "$program" experiment stability --out "$out/stability-$precision" "${stability[@]}" || met=$?
  "$program" experiment pareto --out "$out/pareto-$precision" "${pareto[@]}" || met=$?
  [[ $met -le 1 && -s $out/stability-$precision/summary.json && -s $out/pareto-$precision/summary.json ]] || return 2
  return "$met"
}
both_experiments "$bin/aurasim-single" single > "$out/single.log" 2>&1 &
single=$!
met=0
both_experiments "$bin/aurasim" double || met=$?
wait "$single" || met=$((met > $? ? met : $?))
cat "$out/single.log"
[[ $met -le 1 ]] || exit "$met"
/usr/bin/python3 scripts/plot_accuracy.py "$out"
/usr/bin/python3 scripts/write_accuracy.py "$out"
echo "figures: $out/figures; written: docs/accuracy.md"
exit "$met"
