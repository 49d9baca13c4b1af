#!/usr/bin/env bash
# A part of the collision and loss experiments in real time, over DDS on loopback. Writes
# docs/results.md#correctness_over_dds. About 15 minutes, nearly all of it waiting.
#   scripts/correctness_over_dds.sh [DIR]   DIR: results (build/correctness_over_dds). An interrupted run goes on.
# Fails, after writing everything, when a requirement is not met.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

out=${1:-build/correctness_over_dds}
page=docs/results.md#correctness_over_dds
# shellcheck source=scripts/correctness_runs.sh
source scripts/correctness_runs.sh

options=(--aura none,tight,swept --repeats 20 --domain 61)
run collision --pairs head_on --head-on-values 4 "${options[@]}"
run loss --head-on-values 5 "${options[@]}"
/usr/bin/python3 scripts/write_over_dds.py "$out/collision" "$out/loss"
echo "written: docs/results.md#correctness_over_dds"
[[ $met == yes ]]
