#!/usr/bin/env bash
# Runs shipped scenes in deterministic mode over real DDS processes on 1, 2, 4 and 9 nodes, twice, on a good network and
# on a bad one (16 ms delay, 5 ms jitter, 10% loss on every datagram), and compares the state hash of every step with
# the run on one node. Prints a table in Markdown; exit 1 if anything differs. With no SCENE also writes docs/same_bits.md
# (the part of a network that is not asked for stays as it was). Takes about two hours for everything, a good hour with
# --repetitions 1; goes on where it was stopped.
#   scripts/same_bits.sh [--steps N=1800] [--repetitions N=1] [--network good|bad|both] [--domain N=70]
#                        [--out DIR=build/same_bits] [SCENE ...]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

steps=1800 repetitions=1 network=both domain=70 out=build/same_bits
while [[ ${1:-} == --* ]]; do
  case $1 in
    --steps) steps=$2 ;;
    --repetitions) repetitions=$2 ;;
    --network) network=$2 ;;
    --domain) domain=$2 ;;
    --out) out=$2 ;;
    *) printf 'same_bits.sh: %s?\n' "$1" >&2; exit 2 ;;
  esac
  shift 2
done

aurasim=build/release/aurasim
# shellcheck source=scripts/measured.sh
source scripts/measured.sh
begin_measuring docs/same_bits.md "$out" double aurasim_bench physics_tests_single physics_tests_double
reports=$(mktemp -d)
trap 'rm -rf "$reports"' EXIT

# Metres: so small that bodies change hosts.
declare -A cell=([card_house]=6 [columns_rain]=15 [corner_stacks]=6 [demo]=12 [domino_line]=20 [falling_piles]=8
  [island]=10 [newtons_cradle]=6 [ragdoll_stairs]=6 [three_way]=8 [tower]=8 [tug_of_war]=10 [two_spheres]=10
  [vehicle_tour]=9 [far_out]=6)

# The overrides that cut a scene into so many regions, one per line.
cut() {
  local scene=$1 nodes=$2 side=${cell[$1]}
  if [[ $scene == far_out ]]; then
    local rows=1 columns=2 boxes=() row column
    case $nodes in 1) columns=1 ;; 4) rows=2 ;; 9) rows=3 columns=3 ;; esac
    for ((row = 0; row < rows; ++row)); do
      for ((column = 0; column < columns; ++column)); do
        boxes+=("[$((99999 + 6 * (column - columns / 2))), $((6 * (row - rows / 2))), $((99999 + 6 * (column - columns / 2 + 1))), $((6 * (row - rows / 2 + 1)))]")
      done
    done
    local joined
    printf -v joined '%s, ' "${boxes[@]}"
    printf 'regions={layout: boxes, boxes: [%s]}\n' "${joined%, }"
    return
  fi
  case $nodes in
    1) printf 'regions={layout: columns, count: 1, width: %s}\n' "$side" ;;
    2) printf 'regions={layout: columns, count: 2, width: %s}\n' "$side" ;;
    4) printf 'regions={layout: grid, rows: 2, columns: 2, cell: [%s, %s]}\n' "$side" "$side" ;;
    9) printf 'regions={layout: grid, rows: 3, columns: 3, cell: [%s, %s]}\n' "$side" "$side" ;;
  esac
}

run() {
  local report=$1 scene=$2 nodes=$3
  shift 3
  "$aurasim" launch "launch_configs/$scene.yaml" --headless --steps "$steps" --report "$report" \
    --set time.sync=deterministic --set time.pace=none --set "dds.domain=$domain" --set "$(cut "$scene" "$nodes")" "$@" \
    >"$report.log" 2>&1
}

# A number, or how many there are.
field() {
  python3 -c 'import json, sys; f = json.load(open(sys.argv[1]))[sys.argv[2]]; print(len(f) if isinstance(f, list) else f)' "$1" "$2"
}

bad=(--set dds.impair.delay=0.016 --set dds.impair.jitter=0.005 --set dds.impair.loss=0.1)
failures=0
row() {
  local scene=$1 nodes=$2 on=$3 again=$4
  shift 4
  local report=$reports/other verdict cells
  cells="| $scene | $nodes | $on | $again |"
  rm -rf "$report"
  if ! run "$report" "$scene" "$nodes" "$@"; then
    verdict="the run failed: $(tail -n 1 "$report.log")"
  elif verdict=$("$aurasim" compare "$reports/central" "$report"); then
    verdict="equal, $(field "$report/summary.json" steps) steps"
  fi
  cells+=" $(field "$report/summary.json" migrations 2>/dev/null || echo -) |"
  cells+=" $(field "$report/summary.json" redos 2>/dev/null || echo -) | $verdict |"
  [[ $verdict == equal* ]] || failures=$((failures + 1))
  echo "$cells" | tee -a "$out/$on-$steps.md"
}

# The rows that are still to be measured for a scene: NODES NETWORK REPETITION. Those that are there are printed.
missing_rows() {
  local scene=$1 nodes on again
  for ((again = 1; again <= repetitions; ++again)); do
    for nodes in 2 4 9; do
      for on in good bad; do
        [[ $network == both || $network == "$on" ]] || continue
        grep -s "^| $scene | $nodes | $on | $again |.*| equal" "$out/$on-$steps.md" >&2 || echo "$nodes $on $again"
      done
    done
  done
}

scenes=("$@")
[[ ${#scenes[@]} -gt 0 ]] || mapfile -t scenes < <(printf '%s\n' "${!cell[@]}" | sort)
printf '| scene | nodes | network | repetition | hand-offs | redos | against one node |\n|---|---|---|---|---|---|---|\n'
for scene in "${scenes[@]}"; do
  mapfile -t rows < <(missing_rows "$scene")
  [[ ${#rows[@]} -gt 0 ]] || continue
  rm -rf "$reports/central"
  run "$reports/central" "$scene" 1 || { cat "$reports/central.log" >&2; exit 1; }
  for row in "${rows[@]}"; do
    read -r nodes on again <<<"$row"
    if [[ $on == good ]]; then row "$scene" "$nodes" good "$again"; else row "$scene" "$nodes" bad "$again" "${bad[@]}"; fi
  done
done

# What the page says besides.
if [[ $# -eq 0 ]]; then
  build/release/aurasim_bench --benchmark_filter='hand_off/|plain_bullet' --benchmark_format=json \
    2>/dev/null >"$out/bench.json"
  for precision in double single; do
    "build/release/physics_tests_$precision" --gtest_filter='LocalOrigin.*' --gtest_output="json:$out/far_out_$precision.json" \
      >/dev/null
  done
  /usr/bin/python3 scripts/write_same_bits.py "$out" --steps "$steps"
  echo "written: docs/same_bits.md" >&2
fi
exit $((failures > 0))
