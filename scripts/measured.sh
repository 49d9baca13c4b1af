# Sourced by the scripts that measure what a page of docs/ says: which page is measured from what,
# and the line by which a page says with what it was measured. Run from the repository's root.
# shellcheck shell=bash

# What a page's figures depend on. Who writes the text does not matter, what is run does.
simulation="CMakeLists.txt src/core src/physics src/node src/transport"
# Counts what is late, and changes nothing: for pages of bits, errors and times.
uncounted="$simulation :!src/node/collision_watch.*"
# shellcheck disable=SC2034
declare -A measures=(
  [docs/results.md#same_bits]="$uncounted src/config src/dds src/process/node_process* idl qos launch_configs scripts/same_bits.sh scripts/scene_regions.sh"
  [docs/results.md#saved_worlds]="$uncounted src/cut src/config src/dds src/process/node_process* src/cut/saved_world.cpp idl qos
    launch_configs src/lab/scenes tests/bench/save_bench.cpp scripts/saved_worlds.sh scripts/scene_regions.sh"
  [docs/results.md#recovery]="$uncounted src/cut src/config src/dds src/process/node_process* src/process/checkpoints.* src/process/restore_plan.*
    src/launch/launcher.cpp idl qos launch_configs scripts/recovery.py scripts/recovery_cost.py"
  [docs/results.md#security_cost]="$uncounted src/config src/dds src/security src/process/node_process* src/launch/launcher.cpp idl qos
    launch_configs scripts/security_cost.py"
  [docs/results.md#control_cost]="$uncounted src/dds src/client src/agent src/process/node_process* idl qos tests/bench/control_client.cpp
    scripts/control_cost.py"
  [docs/results.md#page_traffic]="src/overseer src/node/replica_feed.* src/dds/replica_codec.* src/dds/body_columns.h tests/web/traffic.mjs
    scripts/page_traffic.py"
  # Packages, megabytes and minutes of a fresh Debian 12.
  [docs/installing.md]="CMakeLists.txt CMakePresets.json scripts/setup.sh scripts/demo.sh scripts/build.sh scripts/build_web.sh
    scripts/fetch_npm.cmake"
)

# PAGE -> the paths, one per line; git expands what stands for several.
paths_of_page() {
  local paths
  read -rd '' -a paths <<<"${measures[$1]}" || true
  printf '%s\n' "${paths[@]}"
}

# COMMIT PAGE: the commits since then that change what the page measures.
changes_since() {
  local paths
  mapfile -t paths < <(paths_of_page "$2")
  git log --format='%h %s' "$1..HEAD" -- "${paths[@]}"
}

# DIR [--OPTION VALUE]...: the folder that --out names, or else DIR.
out_of() {
  local out=$1
  shift
  while [[ ${1:-} == --* ]]; do
    [[ $1 != --out ]] || out=$2
    shift 2
  done
  printf '%s\n' "$out"
}

# "Measured: commit ...; build ...; precision ...", of the release build as it is now.
measured_line() {
  local page=$1 precision=$2 build=build/release commit=unknown paths compiler build_type
  mapfile -t paths < <(paths_of_page "$page")
  if commit=$(git rev-parse --short=12 HEAD 2>/dev/null); then
    [[ -z $(git status --porcelain -- "${paths[@]}") ]] || commit+=" with changes"
  else
    commit=unknown
  fi
  compiler=$(sed -nE 's/^set\(CMAKE_CXX_COMPILER_(ID|VERSION) "(.*)"\)/\2/p' "$build"/CMakeFiles/*/CMakeCXXCompiler.cmake)
  build_type=$(sed -n 's/^CMAKE_BUILD_TYPE:[A-Z]*=//p' "$build/CMakeCache.txt")
  printf 'Measured: commit %s; build %s, %s; precision %s.\n' "$commit" "${compiler//$'\n'/ }" "$build_type" "$precision"
}

# PAGE DIR PRECISION [TARGET...]: before anything is measured. Builds, and notes with what in DIR/measured.txt. Results
# that lie there are gone on with only if nothing has changed since that they measure.
begin_measuring() {
  local page=$1 out=$2 precision=$3 now before commit
  shift 3
  scripts/build.sh release aurasim "$@" >&2
  now=$(measured_line "$page" "$precision")
  mkdir -p "$out"
  if [[ -s $out/measured.txt ]]; then
    before=$(<"$out/measured.txt")
    [[ $before != "$now" ]] || return 0
    commit=$(sed -nE 's/^Measured: commit ([0-9a-f]{7,40});.*/\1/p' <<<"$before")
    [[ -z $commit || $now == *"with changes"* || ${now#*;} != "${before#*;}" ]] ||
      [[ -n $(changes_since "$commit" "$page" || echo unknown) ]] || return 0
  elif [[ -z $(ls -A "$out") ]]; then
    printf '%s\n' "$now" >"$out/measured.txt"
    return 0
  else
    before="it does not say which"
  fi
  printf '%s: %s holds results of another state of the code (%s). Remove it, or name another folder.\n' \
    "$0" "$out" "$before" >&2
  return 2
}
