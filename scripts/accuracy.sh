#!/usr/bin/env bash
# The stability and pareto experiments, their figures, and docs/accuracy.md.
#   scripts/accuracy.sh [DIR]      DIR: results (build/accuracy); about 8 minutes on 2 cores
# AURASIM_QUICK=1: two steps instead of four, no presets but for the standing piles, and fewer points.
# Fails, after writing everything, when a requirement is not met.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

out=${1:-build/accuracy}
# shellcheck source=scripts/measured.sh
source scripts/measured.sh
begin_measuring docs/accuracy.md "$out" double aurasim-lab

stability=()
pareto=()
if [[ ${AURASIM_QUICK:-0} == 1 ]]; then
  stability=(--step-hz 60,240 --no-presets)
  pareto=(--simulated 2 --substeps 1,4,8 --iterations 10,50)
fi

rm -f "$out"/{stability,pareto}/summary.json
met=0 # 1: done, but not every requirement is met
build/release/aurasim-lab experiment stability --out "$out/stability" "${stability[@]}" || met=$?
build/release/aurasim-lab experiment pareto --out "$out/pareto" "${pareto[@]}" || met=$((met > $? ? met : $?))
[[ $met -le 1 && -s $out/stability/summary.json && -s $out/pareto/summary.json ]] || exit 2
/usr/bin/python3 scripts/plot_accuracy.py "$out"
/usr/bin/python3 scripts/write_accuracy.py "$out"
echo "figures: $out/figures; written: docs/accuracy.md"
exit "$met"
