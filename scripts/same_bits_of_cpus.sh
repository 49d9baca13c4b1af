#!/usr/bin/env bash
# Runs the speed experiment's scenes in small on emulated processors (Debian's qemu-user) and on this one, and
# compares the states: whichever instructions the program chooses, of ours or of the C library, the bits are the same.
# Exit 1 if anything differs.
#   scripts/same_bits_of_cpus.sh [--settings A,B]   as `aurasim-lab experiment speed` has them (balanced,sequential_impulse)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

settings=balanced,sequential_impulse
if [[ ${1:-} == --settings && $# == 2 ]]; then settings=$2; elif (($#)); then sed -n '2,5p' "$0" >&2; exit 2; fi
command -v qemu-x86_64 >/dev/null || { echo "same_bits_of_cpus.sh: needs Debian's qemu-user" >&2; exit 2; }
scripts/build.sh release aurasim-lab >&2
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

# FOLDER [EMULATOR...]
states() {
  local folder=$1 log=$out/log
  shift
  "$@" build/release/aurasim-lab experiment speed --quick --settings "$settings" --out "$folder" >"$log" 2>&1 ||
    { cat "$log" >&2; return 1; }
}

# qemu64: SSE2; Nehalem: SSE4.2; Haswell: AVX2 and fused multiply-add, which the C library uses.
differ=0
echo "| processor | states |"
echo "|---|---|"
states "$out/here"
for processor in qemu64 Nehalem Haswell; do
  states "$out/$processor" qemu-x86_64 -cpu "$processor"
  verdict="as on this one"
  diff -rq "$out/here/states" "$out/$processor/states" >&2 || verdict="**differ**" differ=1
  echo "| $processor | $verdict |"
done
exit "$differ"
