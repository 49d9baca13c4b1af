#!/usr/bin/env bash
# Installs, builds the release preset, runs every test but those labelled "long": as many at a time as there are
# processors, but for those that measure time or start processes.
#   scripts/test.sh [OPTION ...]      OPTION: as for ctest, e.g. -R dds
# AURASIM_SKIP_SETUP=1: install nothing. AURASIM_PRESET=ci: the release preset as a unity build, in build/ci.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

[[ ${AURASIM_SKIP_SETUP:-} == 1 ]] || scripts/setup.sh
preset=${AURASIM_PRESET:-release}
scripts/build.sh "$preset"
exec ctest --test-dir "build/$preset" --output-on-failure -j "$(nproc)" -LE long "$@"
