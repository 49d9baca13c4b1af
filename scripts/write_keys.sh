#!/usr/bin/env bash
# Writes what the program says of its keys into docs/: keys.md below its head, and the JSON schemas for editors.
# To be run after a change of keys; a test fails until it was.
#   scripts/write_keys.sh [PROGRAM=build/release/aurasim]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

program=${1:-build/release/aurasim}
"$program" schema --json launch >docs/aurasim-launch.schema.json
"$program" schema --json scene >docs/aurasim-scene.schema.json

page=docs/keys.md
written=$(mktemp)
trap 'rm -f "$written"' EXIT
{
  sed '/^<!-- keys:/q' "$page"
  "$program" schema --markdown
  sed -n '/^<!-- end of the keys/,$p' "$page"
} >"$written"
cat "$written" >"$page"
