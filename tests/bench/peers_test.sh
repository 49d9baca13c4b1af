#!/usr/bin/env bash
# peers_test.sh: which other engines tests/bench/peers says it has found. Compiles nothing.
set -euo pipefail
peers=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)/peers
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "FAILED: $*" >&2; exit 1; }

# An engine that is installed, as its package of CMake says it, and one that is not.
package=$work/installed/lib/cmake/box3d
mkdir -p "$package"
echo 'add_library(box3d::box3d INTERFACE IMPORTED)' >"$package/box3dConfig.cmake"
printf 'set(PACKAGE_VERSION 0.1.0)\nset(PACKAGE_VERSION_COMPATIBLE TRUE)\n' >"$package/box3dConfigVersion.cmake"
CMAKE_PREFIX_PATH=$work/installed cmake -S "$peers" -B "$work/build" -G Ninja -D CMAKE_DISABLE_FIND_PACKAGE_Jolt=ON \
  >"$work/log" || fail "cmake: $(cat "$work/log")"

engines=$work/build/engines.txt
grep -qx "box3d version 0.1.0" "$engines" || fail "AnInstalledEngineIsFoundWithItsVersion: $(cat "$engines")"
grep -qx "jolt left-out" "$engines" || fail "WhatIsNotInstalledIsLeftOut: $(cat "$engines")"
grep -qx "bullet version 3\.[0-9]*" "$engines" || fail "BulletIsThatOfTheSystem: $(cat "$engines")"
targets=$(cmake --build "$work/build" --target help)
grep -q "^box3d_peer:" <<<"$targets" || fail "AnInstalledEngineGetsADriver: $targets"
! grep -q "^jolt:" <<<"$targets" || fail "WhatIsLeftOutGetsNoDriver: $targets"
