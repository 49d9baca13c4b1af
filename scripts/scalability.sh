#!/usr/bin/env bash
# The scalability and bandwidth experiments, their figures, and docs/scalability.md.
#   scripts/scalability.sh [DIR]      DIR: results (build/scalability). An interrupted run goes on where it stopped.
# With AURASIM_WALL=1 also one and two real nodes over DDS by the wall clock; only where nothing else runs.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

out=${1:-build/scalability}
aurasim=build/release/aurasim
[[ -x $aurasim ]] || scripts/build.sh release

run() { "$aurasim" experiment scalability --out "$out/scalability" "$@"; }
run --series columns,corners,cuts,weak,border,asleep,uncertainty,lookahead --aura swept,tight,thesis
"$aurasim" experiment bandwidth --out "$out/bandwidth"
if [[ ${AURASIM_WALL:-0} == 1 ]]; then
  "$aurasim" experiment scalability --processes --series columns,cuts --columns 1,2 --aura swept --out "$out/wall"
fi
/usr/bin/python3 scripts/plot_scalability.py "$out/scalability"
/usr/bin/python3 scripts/write_scalability.py "$out"
echo "figures: $out/scalability/figures; written: docs/scalability.md"
