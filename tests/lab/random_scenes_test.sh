#!/usr/bin/env bash
# Random worlds on their regions and on one node: none may differ, none may have a late collision that nobody names.
#   random_scenes_test.sh PROGRAM LAST_SEED [OPTION ...]     more of `experiment scenes`
set -euo pipefail

out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
status=0
"$1" experiment scenes --seeds "1-$2" --steps 400 --threads 2 --no-shrink --out "$out" "${@:3}" || status=$?
cat "$out/summary.json"
exit "$status"
