#!/usr/bin/env bash
# What ctest calls: builds the page if need be and runs one kind of its tests. Ends with 77, which ctest takes for
# "skipped", when there is no node or no browser to run them in.
#   tests/web/run.sh units|page|real_run
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

skip() {
  printf 'skipped: %s; scripts/setup.sh installs it\n' "$*"
  exit 77
}

command -v node >/dev/null && command -v npm >/dev/null || skip "there is no node or no npm"
[[ $1 == units || -x ${AURASIM_CHROMIUM:-/usr/bin/chromium} ]] || skip "there is no chromium"
../../scripts/build_web.sh --tests

case $1 in
  units) exec node node_modules/vitest/vitest.mjs run ;;
  page | real_run) exec node --test "$1.browser.mjs" ;;
  *) printf 'run.sh: %s?\n' "$1" >&2; exit 2 ;;
esac
