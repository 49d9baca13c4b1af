#!/usr/bin/env bash
# Builds the page of the viewer into src/overseer/web/dist, when a source of it is newer than that. Needs node and npm;
# the packages of package-lock.json come from the npm registry, once.
#   scripts/build_web.sh [--tests]      --tests: also installs what the tests in tests/web need
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

fail() {
  printf 'build_web.sh: %s\n' "$*" >&2
  exit 1
}

check_tools() {
  command -v node >/dev/null && command -v npm >/dev/null || fail "needs node and npm; scripts/setup.sh installs them"
  local major
  major=$(node -p 'process.versions.node.split(".")[0]')
  ((major >= 18)) || fail "needs node 18 or later, $(command -v node) is $(node --version)"
}

# npm writes node_modules/.package-lock.json last, so a broken installation is begun anew.
install_packages() {
  local folder=$1
  [[ $folder/node_modules/.package-lock.json -nt $folder/package-lock.json ]] && return
  check_tools
  printf 'build_web.sh: installing the npm packages of %s\n' "$folder"
  # npm 11 refuses a lock file without the optional packages of other platforms, which a registry need not have: the
  # second command takes what is locked and fetches the rest by package.json, which names exact versions.
  local options=(--no-audit --no-fund --no-progress --loglevel=error)
  (cd "$folder" && { npm ci "${options[@]}" 2>/dev/null || npm install --no-save "${options[@]}"; }) ||
    fail "npm cannot install the packages of $folder"
  touch "$folder/node_modules/.package-lock.json"
}

is_up_to_date() {
  local page=$1
  [[ -f $page/dist/index.html ]] || return 1
  [[ -z $(find "$page"/{src,public,index.html,package-lock.json,vite.config.js} -newer "$page/dist/index.html" -print -quit) ]]
}

# One at a time: a test run may ask for the page twice at once.
mkdir -p build
exec 9>build/.web_lock
flock 9

page=src/overseer/web
if ! is_up_to_date "$page"; then
  install_packages "$page"
  check_tools
  (cd "$page" && npm run --silent build) || fail "the page could not be built"
fi
[[ ${1:-} != --tests ]] || install_packages tests/web
