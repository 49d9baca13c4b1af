#!/usr/bin/env bash
# The collision and loss experiments in virtual time, their figures, and docs/correctness.md.
#   scripts/correctness.sh [DIR]      DIR: results (build/correctness). An interrupted run goes on where it stopped.
# Fails, after writing everything, when a requirement is not met.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

out=${1:-build/correctness}
page=docs/correctness.md
# shellcheck source=scripts/correctness_runs.sh
source scripts/correctness_runs.sh

run collision --virtual
run loss --virtual
/usr/bin/python3 scripts/plot_collision.py "$out/collision" --loss "$out/loss"
/usr/bin/python3 scripts/write_correctness.py "$out/collision" "$out/loss"
echo "figures: $out/collision/figures; written: docs/correctness.md"
[[ $met == yes ]]
