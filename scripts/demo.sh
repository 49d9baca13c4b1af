#!/usr/bin/env bash
# From a fresh Debian 12 to a running world.
#   scripts/demo.sh [LAUNCH] [OPTION ...]
# LAUNCH: a launch file (launch_configs/demo.yaml). OPTION: as for `aurasim launch`, e.g. --duration 30 or --report DIR.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

if [[ ${1:-} == -h || ${1:-} == --help ]]; then
  sed -n '2,4s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
  exit 0
fi
launch=$root/launch_configs/demo.yaml
if [[ $# -gt 0 && $1 != -* ]]; then
  launch=$1
  shift
fi

"$root/scripts/setup.sh" --demo
# The page is an extra: without it the world runs all the same.
if ! said=$("$root/scripts/build_web.sh" 2>&1); then
  printf 'demo.sh: no page for the viewer (%s); the next start tries again\n' "${said##*$'\n'}" >&2
fi
# Where everything is built already, for tests, it only has to be brought up to date.
preset=demo
! grep -qs 'AURASIM_TESTS:BOOL=ON' "$root/build/release/CMakeCache.txt" || preset=release
echo "demo.sh: building; the first time this takes some minutes"
"$root/scripts/build.sh" $preset aurasim

cat <<'TEXT'

One process per region starts now and stays on this machine (DDS on 127.0.0.1). The table has one line per region:
  bodies          hosted there now; the sum grows while bodies are thrown in
  auras           bodies of other regions that it has been warned of
  sent, received  bodies handed over; the sums agree but for what is on its way
  broken          promises about speed, latency or frame time that did not hold
  rtf             simulated seconds per second; 1.00 keeps up with the clock
Below the table stands the address of the viewer: open it in a browser.
Ctrl-C stops all of it.

TEXT
exec "$root/build/release/aurasim" launch "$launch" "$@"
