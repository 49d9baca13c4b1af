#!/usr/bin/env bash
# Writes what the program says of its keys, asks and topics into docs/: the marked blocks of keys.md, commands.md and
# protocol.md, and the JSON schemas. To be run after a change of keys, asks or topics; a test fails until it was.
#   scripts/write_keys.sh [PROGRAM=build/release/aurasim]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

program=${1:-build/release/aurasim}
"$program" schema --json launch >docs/aurasim-launch.schema.json
"$program" schema --json scene >docs/aurasim-scene.schema.json
"$program" schema --json asks >docs/aurasim-asks.schema.json

written=$(mktemp)
trap 'rm -f "$written"' EXIT

# Writes the standard input between the page's lines "<!-- NAME:" and "<!-- end of the NAME".
write_block() {
  local page=$1 name=$2
  {
    sed "/^<!-- $name:/q" "$page"
    cat
    sed -n "/^<!-- end of the $name/,\$p" "$page"
  } >"$written"
  cat "$written" >"$page"
}
"$program" schema --markdown | write_block docs/keys.md keys
"$program" schema --asks | write_block docs/commands.md asks
"$program" schema --json topics | scripts/topics_table.py | write_block docs/protocol.md topics
