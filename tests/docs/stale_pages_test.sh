#!/usr/bin/env bash
# scripts/stale_pages.sh and scripts/measured.sh in a repository of their own: what makes a page stale, what does not.
set -euo pipefail
command -v git >/dev/null || exit 77
source_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
failures=0

mkdir -p scripts docs src/core src/overseer src/cli
cp "$source_root"/scripts/{measured,stale_pages}.sh scripts
# shellcheck source=scripts/measured.sh
source scripts/measured.sh
export GIT_CONFIG_GLOBAL=/dev/null GIT_CONFIG_SYSTEM=/dev/null
export GIT_{AUTHOR,COMMITTER}_NAME=test GIT_{AUTHOR,COMMITTER}_EMAIL=test@example.org
git init --quiet

commit_all() { git add --all && git commit --quiet --message "$1"; }
commit_to() { # FILE
  mkdir -p "$(dirname "$1")"
  echo "$RANDOM" >>"$1"
  commit_all "change $1"
}
stamp() { # PAGE or PAGE#SECTION [COMMIT]
  local line page=${1%%#*} section=${1#*#}
  line="Measured: commit ${2:-$(git rev-parse --short=12 HEAD)}; build GNU 12.2.0, Release; precision double."
  if [[ $1 == *#* ]]; then
    touch "$page"
    sed -i "/^<a id=\"$section\">/,/^<!-- end of $section -->/d" "$page"
    printf '<a id="%s"></a>\n\n%s\n<!-- end of %s -->\n' "$section" "$line" "$section" >>"$page"
  else
    printf '# A page\n\n%s\n' "$line" >"$page"
  fi
}
stamp_all() {
  local page
  for page in "${!measures[@]}"; do stamp "$page"; done
  commit_all pages
}
expect() { # WHAT PAGE...: the pages that are listed now
  local what=$1 found wanted code=0
  shift
  found=$(scripts/stale_pages.sh -q) || code=$?
  wanted=$(printf '%s\n' "$@" | LC_ALL=C sort)
  if [[ $found != "$wanted" || $code != $(($# > 0)) ]]; then
    failures=$((failures + 1))
    printf 'FAILED: %s\n  wanted: %s\n  found (exit code %s): %s\n' "$what" "${wanted//$'\n'/ }" "$code" "${found//$'\n'/ }"
  fi
}

commit_to src/core/aura.cpp
stamp_all
expect "APageThatWasMeasuredNowIsNotStale"

commit_to src/import/model.cpp
commit_to README.md
expect "WhatIsNotMeasuredMakesNoPageStale"

commit_to src/process/node_process.cpp
of_processes=(docs/results.md#{control_cost,recovery,same_bits,saved_worlds,security_cost})
expect "AFileThatFiveSectionsMeasureMakesThoseStale" "${of_processes[@]}"
stamp docs/results.md#control_cost
expect "ASectionThatIsMeasuredAgainLeavesTheOthersStale" "${of_processes[@]:1}"
stamp docs/results.md#control_cost 0123456789ab
expect "ACommitOfAnotherSectionIsNotTakenForItsOwn" "${of_processes[@]}"
git checkout --quiet docs

commit_to src/core/aura.cpp
of_simulation=()
for page in "${!measures[@]}"; do [[ ! " ${measures[$page]} " =~ \ src/core\  ]] || of_simulation+=("$page"); done
((${#of_simulation[@]} >= 5))
expect "TheProtocolMakesThePagesOfTheSimulationStale" "${of_simulation[@]}"

stamp_all
expect "MeasuredAgainItIsNotStale"

stamp docs/accuracy.md "$(git rev-parse --short=12 HEAD) with changes"
expect "MeasuredWithWhatNoCommitHoldsIsStale" docs/accuracy.md
stamp docs/accuracy.md 0123456789ab
expect "ACommitThatIsNotInTheHistoryIsStale" docs/accuracy.md
echo "# A page" >docs/accuracy.md
expect "APageThatDoesNotSayIsStale" docs/accuracy.md
stamp docs/accuracy.md

stamp docs/unlisted.md
expect "AMeasuredPageThatIsNotListedIsNamed" docs/unlisted.md
rm docs/unlisted.md
stamp docs/results.md#unlisted
expect "AMeasuredSectionThatIsNotListedIsNamed" docs/results.md#unlisted
git checkout --quiet docs/results.md

{ stamp docs/accuracy.md && commit_to src/core/aura.cpp && stamp_all; } >/dev/null
printf 'Measured: commit %s; build x, Release; precision double.\n' "$(git rev-parse HEAD~2)" >>docs/accuracy.md
expect "TheOldestPartOfAPageCounts" docs/accuracy.md
git checkout --quiet docs

# Results that are gone on with. The build is none of this test's business.
mkdir -p build/release/CMakeFiles/3.25
echo 'CMAKE_BUILD_TYPE:STRING=Release' >build/release/CMakeCache.txt
printf 'set(CMAKE_CXX_COMPILER_ID "GNU")\nset(CMAKE_CXX_COMPILER_VERSION "12.2.0")\n' >build/release/CMakeFiles/3.25/CMakeCXXCompiler.cmake
printf '#!/bin/sh\n' >scripts/build.sh
chmod +x scripts/build.sh
echo build/ >.gitignore
commit_all build
refused() { ! (begin_measuring docs/accuracy.md build/results double) 2>/dev/null; }
check() { # WHAT COMMAND...
  if ! "${@:2}"; then
    failures=$((failures + 1))
    echo "FAILED: $1"
  fi
}
not() { ! "$@"; }
check "AnEmptyFolderIsBegunWith" not refused
check "WhatItWasMeasuredWithIsWrittenDown" grep -qx "Measured: commit $(git rev-parse --short=12 HEAD); build GNU 12.2.0, Release; precision double." build/results/measured.txt
commit_to README.md
check "ResultsOfTheSameCodeAreGoneOnWith" not refused
commit_to src/core/aura.cpp
check "ResultsOfAnotherStateAreNotGoneOnWith" refused
rm build/results/measured.txt
echo row >build/results/rows
check "ResultsThatDoNotSayAreNotGoneOnWith" refused

[[ $failures -eq 0 ]] && echo "stale pages: all as they should be"
exit $((failures > 0))
