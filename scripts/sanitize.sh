#!/usr/bin/env bash
# Builds a sanitizer preset and runs the fast tests in it.
#   scripts/sanitize.sh [PRESET=asan] [OPTION ...]      PRESET: asan (addresses, undefined behaviour) or tsan (threads)
# AURASIM_TARGETS="core_tests ...": builds and runs only these.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

preset=${1:-asan}
shift $(($# > 0))
read -ra targets <<<"${AURASIM_TARGETS:-}"
scripts/build.sh "$preset" ${targets:+"${targets[@]}"}
only=()
if ((${#targets[@]})); then only=(-R "^($(IFS='|'; echo "${targets[*]}"))\$"); fi

# GCC 12's ThreadSanitizer cannot start under the wide address randomisation of newer kernels.
without_randomisation=()
if [[ $preset == tsan ]] && setarch --addr-no-randomize true 2>/dev/null; then
  without_randomisation=(setarch --addr-no-randomize)
fi
export UBSAN_OPTIONS=print_stacktrace=1
exec "${without_randomisation[@]}" ctest --test-dir "build/$preset" --output-on-failure -L fast "${only[@]}" "$@"
