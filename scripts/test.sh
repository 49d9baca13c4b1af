#!/usr/bin/env bash
# Installs, builds the release preset, runs every test but those labelled "long": as many at a time as there are
# processors, but for those that measure time or start processes.
#   scripts/test.sh [OPTION ...]      OPTION: as for ctest, e.g. -R dds
# AURASIM_SKIP_SETUP=1: install nothing.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

[[ ${AURASIM_SKIP_SETUP:-} == 1 ]] || scripts/setup.sh
scripts/build.sh release
exec ctest --test-dir build/release --output-on-failure -j "$(nproc)" -LE long "$@"
