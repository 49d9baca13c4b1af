#!/usr/bin/env bash
# Kills nodes of real runs at random, 100 times one and 20 times two at once, and compares every state with that of the run
# that nobody disturbed; restarts all nodes one after the other; measures what keeping parts costs a healthy run. Stores the
# suite recovery. About 35 minutes on 2 cores, where nothing else runs, those of the long run, and half an hour
# for a day in virtual time; goes on where it was stopped.
#   scripts/recovery.sh [--deaths N=100] [--pairs N=20] [--soak MINUTES=60] [--hours N=24] [--domain N=73]
#                       [--out DIR=build/recovery]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

deaths=100 pairs=20 soak=60 hours=24 domain=73 out=build/recovery
while [[ ${1:-} == --* ]]; do
  case $1 in
    --deaths) deaths=$2 ;;
    --pairs) pairs=$2 ;;
    --soak) soak=$2 ;;
    --hours) hours=$2 ;;
    --domain) domain=$2 ;;
    --out) out=$2 ;;
    *) printf 'recovery.sh: %s?\n' "$1" >&2; exit 2 ;;
  esac
  shift 2
done

scripts/build.sh release aurasim aurasim-lab >&2
mkdir -p "$out"
commit=$(git describe --always --dirty)
if [[ -s $out/commit && $(<"$out/commit") != "$commit" ]]; then
  echo "recovery.sh: $out holds results of $(<"$out/commit"), and this is $commit. Remove it, or name another folder" >&2
  exit 2
fi
echo "$commit" >"$out/commit"
failures=0
/usr/bin/python3 scripts/recovery.py --deaths "$deaths" --pairs "$pairs" --domain "$domain" --out "$out" || failures=1
[[ -s $out/rolling.jsonl ]] || /usr/bin/python3 scripts/recovery_rolling.py --domain "$domain" --out "$out" || failures=1
/usr/bin/python3 scripts/recovery_cost.py --domain "$domain" --out "$out"
[[ $soak == 0 || -s $out/soak.jsonl ]] ||
  /usr/bin/python3 scripts/recovery_rolling.py --repeats 0 --soak "$soak" --domain "$domain" --out "$out" || failures=1
[[ $hours == 0 || -s $out/endurance.jsonl ]] || {
  build/release/aurasim-lab experiment endurance tower --hours "$hours" >"$out/endurance.part" || failures=1
  mv "$out/endurance.part" "$out/endurance.jsonl"
}
exit "$failures"
