#!/usr/bin/env bash
# The speed of our step beside that of other engines, on the same bodies in one run; docs/speed.md shows it.
#   scripts/peers.sh [--out DIR] [--repeats N] [--cases A,B] [--settings A,B] [--once S] [--quick]
# It builds no other engine. It links those of Jolt, box3d and Bullet that are installed, says which were found, and
# leaves the others out. CMAKE_PREFIX_PATH in the environment names folders in which engines are installed.
#   --out       results (build/speed); an interrupted run of the same commit goes on where it stopped
#   --repeats   runs of each, by turns, of which the medians are stored (5)
#   --once      what takes more CPU seconds than this is run once: it averages by itself (120)
#   --settings  of our step, as `aurasim-lab experiment speed` has them (fast,balanced,sequential_impulse); exact is slow
#   --quick     small scenes, one run of each; the results are stored in DIR instead of docs/results
# Nothing else should run meanwhile. About two hours on 2 cores; a minute or two with --quick.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

out=build/speed repeats=5 cases=rain,pyramid,hulls,ragdolls,card_houses,gas,sleepers once=120
settings=fast,balanced,sequential_impulse results=docs/results quick=()
usage() { sed -n '2,/^set -/{/^#/s/^# \{0,1\}//p}' "scripts/peers.sh" >&2; exit 2; }
while (($#)); do
  case $1 in
    --quick) quick=(--quick) ;;
    --out | --repeats | --cases | --settings | --once)
      (($# > 1)) || usage
      declare "${1#--}=$2"
      shift
      ;;
    *) usage ;;
  esac
  shift
done
if [[ ${#quick[@]} -gt 0 ]]; then repeats=1 results=$out; fi
read -r load _ </proc/loadavg
[[ ${#quick[@]} -gt 0 || ${load%.*} -eq 0 ]] || echo "peers.sh: something else runs here (load $load)" >&2
scripts/build.sh release aurasim-lab >&2
mkdir -p "$out"

rm -rf build/peers/bin
cmake -S tests/bench/peers -B build/peers -G Ninja >"$out/peers_build.log" 2>&1 ||
  { echo "peers.sh: cmake has failed, see $out/peers_build.log" >&2; exit 1; }
cmake --build build/peers -- -k 0 >>"$out/peers_build.log" 2>&1 ||
  echo "peers.sh: an engine that is installed cannot be linked, see $out/peers_build.log" >&2
built() { [[ -x build/peers/bin/$1 ]]; } # PROGRAM

# Which engines there are: they are named on standard error, for the sentence of docs/speed.md about them.
{
  [[ ${#quick[@]} == 0 ]] || echo "small scenes"
  while read -r engine found; do
    if [[ $found != left-out && -z $(compgen -G "build/peers/bin/$engine*") ]]; then found=not-linked; fi
    echo "$engine $found"
  done <build/peers/engines.txt
} >"$out/engines.txt"
sed -nE 's/^(.*) version (.*)/peers.sh: found \1, version \2/p; s/^(.*) left-out$/peers.sh: \1 is not installed, and left out/p
  s/^(.*) not-linked$/peers.sh: \1 is installed, but cannot be linked, and is left out/p' "$out/engines.txt" >&2

build/release/aurasim-lab experiment speed --out "$out" --cases "$cases" --repeats 0 "${quick[@]}"

# SCENE ENGINE PRECISION THREADS: is one more run of it wanted in this turn?
wanted() {
  [[ -s $out/runs.csv ]] || return 0
  awk -F, -v of="$1,$2,$3,$4" -v turn="$turn" -v once="$once" '
    $1 "," $2 "," $3 "," $4 == of { ++runs; if ($7 > 1000 * once) turn = 1 }
    END { exit !(runs < turn) }' "$out/runs.csv"
}
ours() { # SCENE THREADS
  local name
  for name in ${settings//,/ }; do
    [[ $2 == 1 || $name =~ ^(fast|balanced|12_substeps)$ ]] || continue # the others know no threads
    wanted "$1" "aurasim-$name" double "$2" || continue
    build/release/aurasim-lab experiment speed --out "$out" --cases "$1" --settings "$name" --threads "$2" "${quick[@]}" \
      >/dev/null 2>&1
  done
}
peer() { # SCENE PROGRAM ENGINE PRECISION THREADS
  built "$2" || return 0
  wanted "$1" "$3" "$4" "$5" || return 0
  "build/peers/bin/$2" "$out/scenes/$1.txt" "$out" "$5" || echo "peers.sh: $3 has failed on $1" >&2
}
for ((turn = 1; turn <= repeats; ++turn)); do
  for scene in ${cases//,/ }; do
    echo "turn $turn of $repeats: $scene"
    for threads in 1 2; do ours "$scene" "$threads"; done
    for precision in double single; do peer "$scene" "bullet_$precision" bullet "$precision" 1; done
    for threads in 1 2; do
      for engine in jolt box3d; do peer "$scene" "$engine" "$engine" single "$threads"; done
    done
  done
done

build/release/aurasim-lab experiment speed-errors --out "$out" --results "$results"
echo "stored: $results/speed.jsonl"
[[ ${#quick[@]} -gt 0 ]] || scripts/render_pages.py docs/speed.md
