#!/usr/bin/env bash
# The installed program needs nothing of the folder that it was built from: that is hidden while it runs.
#   tests/system/install_test.sh BUILD DOMAIN
set -euo pipefail
build=$1 domain=$2

skip() {
  printf 'skipped: %s\n' "$*"
  exit 77
}

fail() {
  printf 'install_test.sh: %s\n' "$*" >&2
  exit 1
}

inside() {
  cd "$work"
  ! compgen -G "$source/*" >/dev/null || fail "the sources can still be seen"
  local said
  said=$(aurasim --version)
  echo "$said"
  grep -q ", GCC" <<<"$said" || fail "that is no version"
  aurasim check far_out >/dev/null
  aurasim launch two_spheres --headless --steps 60 --report report --set dds.domain="$domain"
  [[ -s report/summary.json ]] || fail "there is no report"
  bash -n usr/share/bash-completion/completions/aurasim
  ! command -v zsh >/dev/null || zsh -n usr/share/zsh/vendor-completions/_aurasim
  head -n 1 usr/share/man/man1/aurasim.1 | grep -q '^\.TH AURASIM 1'
  [[ ! -f usr/share/aurasim/web/index.html ]] || serves_its_page
}

serves_its_page() (
  aurasim overseer demo --port 0 --set dds.domain="$domain" >address &
  overseer=$!
  # shellcheck disable=SC2064
  trap "kill $overseer; wait $overseer || true" EXIT
  for ((i = 0; i < 600; ++i)); do
    [[ ! -s address ]] || break
    sleep 0.1
  done
  port=$(sed -n 's|^http://127.0.0.1:\([0-9]*\)/.*|\1|p' address)
  exec 3<>"/dev/tcp/127.0.0.1/$port"
  printf 'GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n' >&3
  grep -q "<title>aurasim</title>" <&3 || fail "the page is not served"
)

# Again in a view of the files in which the sources are hidden.
if [[ -n ${AURASIM_HIDE:-} ]]; then
  source=$AURASIM_HIDE work=$3
  mount -t tmpfs none "$source"
  PATH=$work/usr/bin:$PATH
  inside
  exit
fi
unshare --map-root-user --mount true 2>/dev/null || skip "nobody may have a view of the files of his own here"
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --prefix "$work/usr" >/dev/null
cp "${BASH_SOURCE[0]}" "$work/test.sh"
AURASIM_HIDE=$source unshare --map-root-user --mount bash "$work/test.sh" "$build" "$domain" "$work"
