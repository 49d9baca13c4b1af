#!/usr/bin/env bash
# Builds the page of the viewer into src/overseer/web/dist, when a source of it is newer than that: Debian's esbuild
# makes one script of it and of three.js, which comes from the npm registry, once, and must have the hash of
# package-lock.json. On failure the last line says why, and what was built before stays.
#   scripts/build_web.sh [--tests]      --tests: also installs what the tests in tests/web need; that needs node and npm
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
page=src/overseer/web

fail() {
  printf 'build_web.sh: %s\n' "$*" >&2
  exit 1
}

# As npm is told it: by environment, by ~/.npmrc.
registry() {
  local url=${npm_config_registry:-${NPM_CONFIG_REGISTRY:-}}
  [[ -n $url || ! -r ~/.npmrc ]] || url=$(sed -n 's/^registry *= *//p' ~/.npmrc | tail -n 1)
  url=${url:-https://registry.npmjs.org}
  printf '%s' "${url%/}"
}

fetch_three() {
  local folder=$page/node_modules/three version hash said
  version=$(sed -n 's/.*"three": "\([0-9.]*\)".*/\1/p' $page/package.json)
  grep -qsF "\"version\": \"$version\"" $folder/package.json && return
  hash=$(grep -A 3 '"node_modules/three"' $page/package-lock.json | sed -n 's/.*"sha512-\([^"]*\)".*/\1/p')
  [[ -n $version && -n $hash ]] || fail "package.json and package-lock.json do not name one three.js"
  hash=$(base64 --decode <<<"$hash" | od -An -v -tx1 | tr -d ' \n')
  mkdir -p $page/node_modules
  said=$(cmake -D URL="$(registry)/three/-/three-$version.tgz" -D SHA512="$hash" -D FOLDER="$PWD/$folder" \
    -P scripts/fetch_npm.cmake 2>&1) || fail "cannot fetch three.js: $(sed '1d; /^$/d' <<<"$said" | tr -s ' \n' ' ')"
}

# The names of the files change with their content, so that a browser never mixes two builds.
bundle() {
  local built=$page/dist.new script style
  rm -rf $built
  (cd $page && esbuild src/main.js src/styles.css --bundle --minify --format=esm --target=es2022 --log-level=warning \
    --entry-names='[name]-[hash]' --outdir=dist.new/assets) || fail "esbuild cannot make the page"
  cp $page/public/* $built/
  script=$(basename $built/assets/main-*.js)
  style=$(basename $built/assets/styles-*.css)
  sed -e "s|\./src/main\.js|./assets/$script|" -e "s|\./src/styles\.css|./assets/$style|" $page/index.html >$built/index.html
  rm -rf $page/dist
  mv $built $page/dist
}

is_up_to_date() {
  [[ -f $page/dist/index.html ]] || return 1
  [[ -z $(find $page/{src,public,index.html,package-lock.json} scripts/build_web.sh -newer $page/dist/index.html -print -quit) ]]
}

build_page() {
  is_up_to_date && return
  command -v esbuild >/dev/null || fail "needs esbuild; scripts/setup.sh installs it"
  fetch_three
  bundle
}

# npm writes node_modules/.package-lock.json last, so a broken installation is begun anew.
install_tests() {
  local folder=tests/web
  [[ $folder/node_modules/.package-lock.json -nt $folder/package-lock.json ]] && return
  command -v node >/dev/null && command -v npm >/dev/null || fail "needs node and npm; scripts/setup.sh installs them"
  local major
  major=$(node -p 'process.versions.node.split(".")[0]')
  ((major >= 18)) || fail "needs node 18 or later, $(command -v node) is $(node --version)"
  printf 'build_web.sh: installing the npm packages of %s\n' "$folder"
  # npm 11 refuses a lock file without the optional packages of other platforms, which a registry need not have: the
  # second command takes what is locked and fetches the rest by package.json, which names exact versions.
  local options=(--no-audit --no-fund --no-progress --loglevel=error)
  (cd "$folder" && { npm ci "${options[@]}" 2>/dev/null || npm install --no-save "${options[@]}"; }) ||
    fail "npm cannot install the packages of $folder"
  touch "$folder/node_modules/.package-lock.json"
}

# One at a time: a test run may ask for the page twice at once.
mkdir -p build
exec 9>build/.web_lock
flock 9
build_page
[[ ${1:-} != --tests ]] || install_tests
