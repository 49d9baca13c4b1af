#!/usr/bin/env bash
# What `scripts/demo.sh` has built can be installed: the rest is left out, and named.
#   tests/system/install_of_demo_test.sh BUILD
set -euo pipefail
build=$1
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)

fail() {
  printf 'install_of_demo_test.sh: %s\n' "$*" >&2
  exit 1
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# As the preset `demo`, of whose targets demo.sh builds only the program: here it is a copy of the one that is tested.
cmake -S "$source" -B "$work/demo" -G Ninja -D CMAKE_BUILD_TYPE=Release -D AURASIM_TESTS=OFF \
  -D CMAKE_UNITY_BUILD=ON >"$work/configured" 2>&1 || fail "$(cat "$work/configured")"
cp "$build/aurasim" "$work/demo/aurasim"
mkdir -p "$work/demo/src/cli/shown"
cp "$build"/src/cli/shown/* "$work/demo/src/cli/shown/"

cmake --install "$work/demo" --prefix "$work/usr" >"$work/said" 2>&1 || fail "$(cat "$work/said")"
[[ -x $work/usr/bin/aurasim ]] || fail "the program is not installed"
for what in "the C++ client library"; do
  grep -q "Left out: $what, which has not been built here" "$work/said" || fail "says nothing of $what: $(cat "$work/said")"
done
for absent in bin/aurasim-import include/aurasim lib/cmake/aurasim lib/python3; do
  [[ ! -e $work/usr/$absent ]] || fail "$absent is installed, without what it needs"
done
! compgen -G "$work/usr/lib/libaurasim_client*" >/dev/null || fail "a library that is not built"
"$work/usr/bin/aurasim" check demo >/dev/null
