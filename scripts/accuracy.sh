#!/usr/bin/env bash
# The stability and pareto experiments in both precisions, side by side, their figures, and docs/accuracy.md.
#   scripts/accuracy.sh [DIR]      DIR: results (build/accuracy)
# Fails, after writing everything, when a requirement is not met.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

out=${1:-build/accuracy}
bin=build/release
[[ -x $bin/aurasim && -x $bin/aurasim-single ]] || scripts/build.sh release

# 1: done, but not every requirement is met
both_experiments() {
  local program=$1 precision=$2 met=0
  for experiment in stability pareto; do
    rm -f "$out/$experiment-$precision/summary.json"
    "$program" experiment "$experiment" --out "$out/$experiment-$precision" || met=$?
    [[ $met -le 1 && -s $out/$experiment-$precision/summary.json ]] || return 2
  done
  return "$met"
}
mkdir -p "$out"
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
