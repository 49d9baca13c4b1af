#!/usr/bin/env bash
# Installs, builds the release preset, runs every test but those labelled "long": one more at a time than there are
# processors, since most of them wait for real runs, but for those that want the machine for themselves.
#   scripts/test.sh [OPTION ...]      OPTION: as for ctest, e.g. -R dds
# AURASIM_SKIP_SETUP=1: install nothing.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

[[ ${AURASIM_SKIP_SETUP:-} == 1 ]] || scripts/setup.sh
scripts/build.sh release
exec ctest --test-dir build/release --output-on-failure -j "$(($(nproc) + 1))" -LE long "$@"
