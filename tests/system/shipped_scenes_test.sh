#!/usr/bin/env bash
# Every shipped scene as real processes over DDS, by a script that compares state hashes with a run on one node.
#   tests/system/shipped_scenes_test.sh AURASIM SCRIPT [OPTION ...]
set -euo pipefail
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
AURASIM=$1 AURASIM_SKIP_BUILD=1 "$2" "${@:3}" --out "$out"
