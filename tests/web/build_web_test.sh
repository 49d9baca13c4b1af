#!/usr/bin/env bash
# What scripts/build_web.sh does when three.js cannot be had, or is not what the lock file names: it says so in one line,
# and leaves the page as it was. Without a network.
set -euo pipefail
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
command -v esbuild >/dev/null || { echo "skipped: there is no esbuild; scripts/setup.sh installs it"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
  printf 'build_web_test.sh: %s\n' "$*" >&2
  exit 1
}

# REGISTRY WORDS: the build fails, and the only line that it prints has these words.
expect_refusal() {
  local said
  if said=$(npm_config_registry=$1 "$work/scripts/build_web.sh" 2>&1); then fail "$1 was good enough"; fi
  [[ $(wc -l <<<"$said") == 1 && $said == *"$2"* ]] || fail "it said: $said"
  [[ $(cat "$work/src/overseer/web/dist/index.html") == "the page of yesterday" ]] || fail "the old page is gone"
}

mkdir -p "$work"/{scripts,src/overseer/web/dist,registry/three/-}
cp "$source"/scripts/{build_web.sh,fetch_npm.cmake} "$work/scripts"
cp -r "$source"/src/overseer/web/{src,public,index.html,package.json,package-lock.json} "$work/src/overseer/web"
echo "the page of yesterday" >"$work/src/overseer/web/dist/index.html"
touch -d yesterday "$work/src/overseer/web/dist/index.html"

expect_refusal http://127.0.0.1:9 "cannot fetch three.js"
version=$(sed -n 's/.*"three": "\(.*\)".*/\1/p' "$source/src/overseer/web/package.json")
echo "not three.js" >"$work/registry/three/-/three-$version.tgz"
expect_refusal "file://$work/registry" "is not what package-lock.json names"

# A page that is up to date asks for nothing.
touch "$work/src/overseer/web/dist/index.html"
npm_config_registry=http://127.0.0.1:9 "$work/scripts/build_web.sh"
