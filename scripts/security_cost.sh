#!/usr/bin/env bash
# What keys cost: the demo open and secure, by turns, with a node killed as well; and what an attack on the overseer costs
# its nodes. Writes docs/results.md#security_cost. About 15 minutes on 2 cores, where nothing else runs.
#   scripts/security_cost.sh [--repeats N=5] [--domain N=74] [--out DIR=build/security_cost]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# shellcheck source=scripts/measured.sh
source scripts/measured.sh
out=$(out_of build/security_cost "$@")
begin_measuring docs/results.md#security_cost "$out" double
/usr/bin/python3 scripts/security_cost.py "$@"
echo "written: docs/results.md#security_cost" >&2
