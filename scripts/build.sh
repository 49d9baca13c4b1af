#!/usr/bin/env bash
# Configures and builds one preset of CMakePresets.json into build/PRESET.
#   scripts/build.sh [PRESET=release] [TARGET ...]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=${1:-release}
shift $(($# > 0))
cmake --preset "$preset"
cmake --build --preset "$preset" --parallel "$(nproc)" ${1:+--target "$@"}
