#!/usr/bin/env bash
# The stability and pareto experiments, their figures, and docs/accuracy.md.
#   scripts/accuracy.sh [DIR]      DIR: results (build/accuracy); about 8 minutes on 2 cores
# AURASIM_QUICK=1: two steps instead of four, no presets but for the standing piles, and fewer points.
# Fails, after writing everything, when a requirement is not met.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

out=${1:-build/accuracy}
lab=build/release/aurasim-lab
# shellcheck source=scripts/measured.sh
source scripts/measured.sh
begin_measuring docs/accuracy.md "$out" double aurasim-lab

stability=()
pareto=()
if [[ ${AURASIM_QUICK:-0} == 1 ]]; then
  stability=(--step-hz 60,240 --no-presets)
  pareto=(--simulated 2 --substeps 1,4,8 --iterations 10,50)
fi

# 1: done, but not every requirement is met
met=0
rm -f "$out"/{stability,pareto}-double/summary.json
"$lab" experiment stability --out "$out/stability-double" "${stability[@]}" || met=$?
"$lab" experiment pareto --out "$out/pareto-double" "${pareto[@]}" || met=$?
[[ $met -le 1 && -s $out/stability-double/summary.json && -s $out/pareto-double/summary.json ]] || exit 2
/usr/bin/python3 scripts/plot_accuracy.py "$out"
/usr/bin/python3 scripts/write_accuracy.py "$out"
echo "figures: $out/figures; written: docs/accuracy.md"
exit "$met"
