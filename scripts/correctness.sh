#!/usr/bin/env bash
# The collision and loss experiments in virtual time, their figures, and docs/correctness.md.
#   scripts/correctness.sh [DIR]      DIR: results (build/correctness). An interrupted run goes on where it stopped.
# Fails, after writing everything, when a requirement is not met.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

out=${1:-build/correctness}
aurasim=build/release/aurasim
[[ -x $aurasim ]] || scripts/build.sh release

met=yes
# 1: done, but not every requirement is met
run() { "$aurasim" experiment "$1" --virtual --out "$out/$1" || { [[ $? == 1 && -s $out/$1/summary.json ]] && met=no; }; }
rm -f "$out"/{collision,loss}/summary.json
run collision
run loss
/usr/bin/python3 scripts/plot_collision.py "$out/collision" --loss "$out/loss"
/usr/bin/python3 scripts/write_correctness.py "$out/collision" "$out/loss"
echo "figures: $out/collision/figures; written: docs/correctness.md"
[[ $met == yes ]]
