#!/usr/bin/env bash
# Builds tests with a sanitizer and runs them: all fast ones with asan, those of threads with tsan.
#   scripts/sanitize.sh [PRESET=asan] [OPTION ...]
#     PRESET: asan (addresses, undefined behaviour) or tsan (threads); OPTION: as for ctest, e.g. -R core
# AURASIM_TARGETS="core_tests ...": builds and runs only these.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=${1:-asan}
shift $(($# > 0))
case $preset in
  asan) label=fast ;;
  tsan) label=threads ;;
  *) printf 'sanitize.sh: no preset %s; there are asan and tsan\n' "$preset" >&2; exit 2 ;;
esac
read -ra targets <<<"${AURASIM_TARGETS:-${label}_tests}"
scripts/build.sh "$preset" "${targets[@]}"
only=()
if [[ -n ${AURASIM_TARGETS:-} ]]; then only=(-R "^($(IFS='|'; echo "${targets[*]}"))\$"); fi

# GCC 12's ThreadSanitizer cannot start under the wide address randomisation of newer kernels.
without_randomisation=()
if [[ $preset == tsan ]] && setarch --addr-no-randomize true 2>/dev/null; then
  without_randomisation=(setarch --addr-no-randomize)
fi
export UBSAN_OPTIONS=print_stacktrace=1
export TSAN_OPTIONS="suppressions=$PWD/scripts/tsan_suppressions.txt history_size=4"
# As many random worlds as a minute's patience allows: an instrumented step takes several times as long.
export AURASIM_SEEDS=${AURASIM_SEEDS:-2}
exec "${without_randomisation[@]}" ctest --test-dir "build/$preset" --output-on-failure -j "$(nproc)" -L "$label" "${only[@]}" "$@"
