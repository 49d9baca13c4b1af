#!/usr/bin/env bash
# What a page is sent of 10,000 bodies that all move: everything, and only what its camera may see. Writes
# docs/results.md#page_traffic. About 3 minutes.
#   scripts/page_traffic.sh [--bodies N=10000] [--domain N=76] [--out DIR=build/page_traffic]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# shellcheck source=scripts/measured.sh
source scripts/measured.sh
out=$(out_of build/page_traffic "$@")
begin_measuring docs/results.md#page_traffic "$out" double
scripts/build_web.sh --tests
/usr/bin/python3 scripts/page_traffic.py "$@"
echo "written: docs/results.md#page_traffic" >&2
