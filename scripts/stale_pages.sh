#!/usr/bin/env bash
# Which pages of docs/ have figures that are older than what they measure? A measured page says near its top
#   Measured: commit COMMIT; build COMPILER, BUILD TYPE; precision PRECISION.
# once, or once for each of its parts. Sections of a page that have scripts of their own count as pages: PAGE#SECTION.
# scripts/measured.sh has the list of both, and of what each depends on. Lists those that are stale, with the commits
# since then; exit 1 if there are any.
#   scripts/stale_pages.sh [-q]      -q: only the names of the pages
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=scripts/measured.sh
source scripts/measured.sh

quiet=no
[[ ${1:-} != -q ]] || quiet=yes
git rev-parse --verify --quiet HEAD >/dev/null || { echo "stale_pages.sh: needs the git history" >&2; exit 2; }

stale=0
say() { # PAGE WHY [COMMITS]
  stale=1
  if [[ $quiet == yes ]]; then
    echo "$1"
  else
    printf '%s: %s\n' "$1" "$2"
    [[ -z ${3:-} ]] || printf '    %s\n' "${3//$'\n'/$'\n'    }"
  fi
}

# PAGE or PAGE#SECTION: what it says now.
text_of_page() {
  local file=${1%%#*} section=${1#*#}
  [[ -e $file ]] || return 0
  if [[ $1 == *#* ]]; then
    sed -n "/^<a id=\"$section\"><\/a>\$/,/^<!-- end of $section -->\$/p" "$file"
  else
    cat "$file"
  fi
}

# The pages, and the sections with marks (scripts/page_sections.py), that say with what they were measured.
measured_pages() {
  awk 'FNR == 1 || /^<!-- end of / { section = "" }
       /^<a id="[^"]+"><\/a>$/ { split($0, parts, "\""); section = "#" parts[2] }
       /^Measured: commit/ { print FILENAME section }' docs/*.md
}

judge() {
  local page=$1 commits commit since
  [[ -n ${measures[$page]:-} ]] || { say "$page" "is measured, but scripts/measured.sh does not say from what"; return; }
  mapfile -t commits < <(text_of_page "$page" | sed -nE 's/^Measured: commit ([^;]+);.*/\1/p')
  [[ ${#commits[@]} -gt 0 ]] || { say "$page" "does not say what it was measured with"; return; }
  for commit in "${commits[@]}"; do
    if [[ $commit == *"with changes" || $commit == unknown ]]; then
      say "$page" "was measured with what no commit holds ($commit)"
      return
    fi
    git merge-base --is-ancestor "$commit" HEAD 2>/dev/null || { say "$page" "commit $commit is not in the history"; return; }
    since=$(changes_since "$commit" "$page")
    [[ -z $since ]] || { say "$page" "measured at $commit, $(wc -l <<<"$since") commits ago that matter" "$since"; return; }
  done
}

mapfile -t pages < <({ printf '%s\n' "${!measures[@]}"; measured_pages; } | LC_ALL=C sort -u)
for page in "${pages[@]}"; do judge "$page"; done
exit $stale
