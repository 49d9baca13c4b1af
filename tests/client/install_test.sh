#!/usr/bin/env bash
# A newcomer's way: install aurasim somewhere, build the C++ example against it, run both examples. Then `pip install`
# what was built, without network, and run the Python example again with nothing else.
#   tests/client/install_test.sh BUILD DOMAIN [PYTHON_BUILD]      PYTHON_BUILD: build folder that pip uses
set -euo pipefail
build=$1 domain=$2 pip_build=${3:-$1}
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)

fail() {
  printf 'install_test.sh: %s\n' "$*" >&2
  exit 1
}

ran_well() {
  grep -q "corner_stacks: 4 regions" "$1" && grep -q "thrown up at 8.0 m/s\|thrown up at 7.8 m/s" "$1" || fail "$1: $(cat "$1")"
}

nobody_left() {
  for ((i = 0; i < 300; ++i)); do
    pgrep -f -- "--set dds.domain=$domain( |\$)" >/dev/null || return 0
    sleep 0.1
  done
  fail "processes are left behind"
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
prefix=$work/prefix
cmake --install "$build" --prefix "$prefix" >/dev/null
! grep -rlE '#include [<"](fastdds|fastrtps|Eigen|boost|nlohmann|fmt)' "$prefix/include" || fail "a header of others"

unset AURASIM_PROGRAM
cd "$work"
cp -r "$prefix/share/doc/aurasim/examples" examples
cmake -S examples -B examples/build -G Ninja -D CMAKE_PREFIX_PATH="$prefix" -D CMAKE_BUILD_TYPE=Release >/dev/null
cmake --build examples/build >/dev/null
examples/build/lockstep "$domain" | tee cpp.out
ran_well cpp.out
nobody_left

if [[ -d $prefix/lib/python3/dist-packages/aurasim ]]; then
  PYTHONPATH=$prefix/lib/python3/dist-packages /usr/bin/python3 examples/lockstep.py "$domain" | tee py.out
  ran_well py.out
  nobody_left
  /usr/bin/python3 -m venv --system-site-packages venv
  AURASIM_BUILD=$pip_build PIP_NO_INDEX=1 venv/bin/pip install --quiet --no-build-isolation "$source"
  rm -rf "$prefix"
  env -u PYTHONPATH PATH=/usr/bin:/bin venv/bin/python examples/lockstep.py "$domain" | tee pip.out
  ran_well pip.out
  nobody_left
fi
