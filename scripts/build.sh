#!/usr/bin/env bash
# Configures and builds one preset of CMakePresets.json into build/PRESET.
#   scripts/build.sh [PRESET=release] [TARGET ...]
# AURASIM_UNITY=1: several files of src/ at a time, as the demo is built: in half the time, if all of them are to be.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=${1:-release}
shift $(($# > 0))
unity=()
[[ ${AURASIM_UNITY:-} != 1 ]] || unity=(-DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=12)
cmake --preset "$preset" "${unity[@]}"
cmake --build --preset "$preset" --parallel "$(nproc)" ${1:+--target "$@"}
