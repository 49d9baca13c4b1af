#!/usr/bin/env bash
# The scalability and bandwidth experiments, their figures, and docs/scalability.md.
#   scripts/scalability.sh [DIR]      DIR: results (build/scalability). An interrupted run goes on where it stopped.
# With AURASIM_WALL=1 also one and two real nodes over DDS by the wall clock; only where nothing else runs.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

out=${1:-build/scalability}
lab=build/release/aurasim-lab
# shellcheck source=scripts/measured.sh
source scripts/measured.sh
begin_measuring docs/scalability.md "$out" double aurasim-lab

# FROM, TO: one node needs no lookahead, so its runs are those of another K, too.
copy_one_node() {
  mkdir -p "$2/runs"
  cp "$1"/runs/columns-columns_1x80-* "$2/runs"
}

# One node alone takes half of all the time of the long runs: what compares auras and settings is a third as long.
# Three of each, since the largest frame of a single run may be that of a machine that was held up.
"$lab" experiment scalability --out "$out/long" --series columns,cuts --aura swept --repeats 3
copy_one_node "$out/long" "$out/long_k1"
"$lab" experiment scalability --out "$out/long_k1" --series columns --aura swept --columns 1,2,4,8 --lookahead 1 \
  --repeats 3
"$lab" experiment scalability --out "$out/short" --seconds 20
"$lab" experiment bandwidth --out "$out/bandwidth"
if [[ ${AURASIM_WALL:-0} == 1 ]]; then
  wall=("$lab" experiment scalability --processes --series columns --columns 1,2 --aura swept)
  "${wall[@]}" --out "$out/wall"
  copy_one_node "$out/wall" "$out/wall_k1"
  "${wall[@]}" --out "$out/wall_k1" --lookahead 1 --repeats 3
fi
/usr/bin/python3 scripts/plot_scalability.py "$out/long"
/usr/bin/python3 scripts/plot_scalability.py "$out/short"
/usr/bin/python3 scripts/write_scalability.py "$out"
echo "figures: $out/long/figures and $out/short/figures; written: docs/scalability.md"
