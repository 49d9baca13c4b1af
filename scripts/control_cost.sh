#!/usr/bin/env bash
# What it costs to steer 1,000 bodies, 60 times a second, by one client, and how soon control acts. Writes
# docs/results.md#control_cost. About 15 minutes on 2 cores, where nothing else runs.
#   scripts/control_cost.sh [--repeats N=5] [--domain N=75] [--out DIR=build/control_cost]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# shellcheck source=scripts/measured.sh
source scripts/measured.sh
out=$(out_of build/control_cost "$@")
begin_measuring docs/results.md#control_cost "$out" double control_client aurasim_python
/usr/bin/python3 scripts/control_cost.py "$@"
echo "written: docs/results.md#control_cost" >&2
