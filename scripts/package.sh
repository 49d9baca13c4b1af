#!/usr/bin/env bash
# From a fresh Debian 12 to Debian packages of this: build/package/*.deb.
#   scripts/package.sh [--skip-setup | --only-setup] [--without-page] [--out FOLDER]
# --skip-setup: installs nothing; --only-setup: and builds nothing; --without-page: the viewer has no page, so the npm
# registry need not be reached; --out: also copies them there. AURASIM_COMMIT: what --version says where git does not know.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

fail() {
  printf 'package.sh: %s\n' "$*" >&2
  exit 1
}

setup=1 build=1 page=1 out=''
while [[ $# -gt 0 ]]; do
  case $1 in
    --skip-setup) setup='' ;;
    --only-setup) build='' ;;
    --without-page) page='' ;;
    --out) out=${2:?--out FOLDER} && shift ;;
    *) sed -n '2,/^set -/{/^#/s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}" >&2 && exit 2 ;;
  esac
  shift
done

install_packages() {
  scripts/setup.sh --demo
  # What setup.sh installs for `aurasim import` and Python, and what finds the libraries that programs are linked with.
  local packages_of_import packages_of_python more as_root=()
  eval "$(sed -nE '/^packages_of_(import|python)=\(/,/^\)/p' scripts/setup.sh)"
  more=("${packages_of_import[@]}" "${packages_of_python[@]}" dpkg-dev file ccache)
  ! dpkg-query --show "${more[@]}" >/dev/null 2>&1 || return 0
  [[ $EUID -eq 0 ]] || as_root=(sudo)
  "${as_root[@]}" apt-get -q update
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300 install --yes \
    --no-install-recommends "${more[@]}"
}

[[ -z $setup ]] || install_packages
[[ -n $build ]] || exit 0
[[ -z $page ]] || scripts/build_web.sh || fail "the viewer has no page; --without-page makes packages all the same"

# As the demo is built: several files at a time.
cmake --preset demo -B build/package
cmake --build build/package --parallel "$(nproc)"
rm -f build/package/*.deb
(cd build/package && cpack -G DEB)
[[ -z $out ]] || install -D -m 644 -t "$out" build/package/*.deb
ls -l build/package/*.deb
