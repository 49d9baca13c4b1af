#!/usr/bin/env bash
# The Debian packages of a build, in a Debian 12 that has nothing else: installed, run as the user of the units, and purged
# without a trace. Needs root, mmdebstrap and a mirror; DDS stays in network namespaces of its own. Exit code 77: not here.
#   tests/package/deb_test.sh BUILD SOURCES      BUILD: of preset release, or build/package (scripts/package.sh)
# AURASIM_MIRROR: Debian's packages (http://deb.debian.org/debian). AURASIM_ROOT: a tar of a root made before by this with
# AURASIM_KEEP_ROOT=FILE, which saves its minutes.
set -euo pipefail
build=$(cd "$1" && pwd) sources=$(cd "$2" && pwd)
mirror=${AURASIM_MIRROR:-http://deb.debian.org/debian}

skip() {
  printf 'skipped: %s\n' "$*"
  exit 77
}
fail() {
  printf 'deb_test.sh: FAILED: %s\n' "$*" >&2
  exit 1
}
stage() { printf '%s -- %s\n' "$(date +%T)" "$*"; }

[[ $EUID -eq 0 ]] || skip "needs root"
for tool in cpack dpkg-shlibdeps mmdebstrap unshare ip; do
  command -v $tool >/dev/null || skip "there is no $tool (apt-get install dpkg-dev mmdebstrap iproute2)"
done
unshare --mount --net --pid --fork true 2>/dev/null || skip "no namespaces of one's own here"

work=$(mktemp -d)
root=$work/root
trap 'rm -rf --one-file-system "$work"' EXIT

stage "packages"
(cd "$build" && cpack -G DEB -B "$work/packages" >"$work/cpack.log" 2>&1) || { cat "$work/cpack.log"; fail "cpack"; }
ls -l "$work"/packages/*.deb
if command -v lintian >/dev/null; then
  lintian --allow-root --fail-on error "$work"/packages/*.deb || fail "lintian"
fi

make_root() {
  if [[ -n ${AURASIM_ROOT:-} ]]; then
    mkdir "$root"
    tar -xf "$AURASIM_ROOT" -C "$root"
    return
  fi
  mmdebstrap --quiet --variant=minbase --include=man-db,bash-completion bookworm "$root" "$mirror" >"$work/root.log" 2>&1 ||
    { tail -n 5 "$work/root.log"; skip "mmdebstrap cannot make a root of $mirror"; }
  [[ -z ${AURASIM_KEEP_ROOT:-} ]] || tar -cf "$AURASIM_KEEP_ROOT" -C "$root" .
}

# In the root, with mounts and processes of its own; `alone`: without a network but loopback.
within() {
  unshare --mount --pid --fork --kill-child "${alone[@]}" bash -c '
    mount --make-rprivate /
    mount -t proc proc "$0/proc" && mount -t tmpfs tmpfs "$0/dev/shm" 2>/dev/null
    [[ -n $(ip -o link show up dev lo 2>/dev/null) ]] || ip link set lo up
    exec chroot "$0" /usr/bin/env -i HOME=/root LANG=C.UTF-8 TERM=dumb DEBIAN_FRONTEND=noninteractive \
      PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin "$@"' "$root" "$@"
}
online() { alone=() && within "$@"; }
offline() { alone=(--net) && within "$@"; }
as_user() { offline setpriv --reuid=aurasim --regid=aurasim --clear-groups env HOME=/var/lib/aurasim "$@"; }
apt() { online apt-get -q -y -o Acquire::Retries=3 "$@" >"$work/apt.log" 2>&1 || { tail -n 20 "$work/apt.log"; fail "apt-get $*"; }; }

# Every file but what belongs to apt, dpkg, caches and logs; every package and user.
inventory() {
  (cd "$root" && find . -xdev \( -path ./proc -o -path ./dev -o -path ./tmp -o -path ./run -o -path ./var/cache -o -path ./var/log -o -path ./var/lib/apt \
    -o -path ./var/lib/dpkg -o -path ./packages -o -path ./models \) -prune -o -print | grep -vE '^\./etc/(passwd|group|shadow|gshadow)-$|^\./etc/ld.so.cache$' | LC_ALL=C sort)
  online dpkg-query --show --showformat '${Package} ${db:Status-Abbrev}\n'
  cut -d: -f1 "$root/etc/passwd" "$root/etc/group"
}

stage "a fresh Debian 12"
make_root
cp /etc/resolv.conf "$root/etc/resolv.conf"
mkdir -p "$root/packages" "$root/models"
cp "$work"/packages/*.deb "$root/packages"
cp -r "$sources"/tests/import/models/. "$root/models"
apt update
inventory >"$work/before"

stage "installed"
kib() { du -sk --one-file-system --exclude=./var/cache --exclude=./var/lib/apt "$root" | cut -f1; }
before_kib=$(kib)
apt install --no-install-recommends "/packages/$(cd "$root/packages" && ls aurasim_*.deb)"
brings() {
  printf 'with all that it needs: %d packages, %d MiB on the disk\n' \
    "$(($(online dpkg-query --show | wc -l) - $(grep -c ' ii ' "$work/before")))" "$((($(kib) - $1) / 1024))"
}
brings "$before_kib"
[[ $(online stat -c %U:%a /etc/aurasim/node.env) == root:644 ]] || fail "/etc/aurasim/node.env"
for unit in aurasim-node@ aurasim-spare aurasim-overseer; do
  [[ -f $root/usr/lib/systemd/system/$unit.service ]] || fail "there is no unit $unit"
done
[[ -z $(find "$root/etc/systemd" -name 'aurasim*') ]] || fail "a unit is enabled"

stage "used"
said=$(offline aurasim --version)
echo "$said"
grep -qE "^aurasim [0-9.]+ \(commit [0-9a-f]{7,}(-dirty)?, Release, GCC" <<<"$said" || fail "--version"
offline aurasim check demo
offline man aurasim | grep "one world of rigid bodies" >/dev/null || fail "man aurasim"
# shellcheck disable=SC2016
[[ $(offline bash -c '. /usr/share/bash-completion/bash_completion; for p in aurasim; do __load_completion $p
  COMP_WORDS=($p lau) COMP_CWORD=1; _aurasim; echo -n "${COMPREPLY[*]} "; done') == "launch launch " ]] || fail "completion"
# As the units run it: not as root, in the folder that systemd would make.
online install -d -o aurasim -g aurasim /var/lib/aurasim
as_user bash -c 'cd
  aurasim launch demo --headless --steps 300 --report report >said 2>&1 || { cat said; exit 1; }' || fail "launch demo"
grep -o '"bodies_lost": *[0-9]*' "$root/var/lib/aurasim/report/summary.json"
grep -q '"bodies_lost": *0' "$root/var/lib/aurasim/report/summary.json" || fail "bodies are lost"
! said=$(offline aurasim import /models/none.urdf 2>&1) || fail "import without its package"
grep -q "aurasim-import" <<<"$said" || fail "import does not say what is missing"

if compgen -G "$root/packages/aurasim-import_*.deb" >/dev/null; then
  stage "import, too"
  apt install --no-install-recommends "/packages/$(cd "$root/packages" && ls aurasim-import_*.deb)"
  brings "$before_kib"
  # Its library writes a log into the home of whoever uses it.
  offline env HOME=/tmp aurasim import /models/arm.urdf --out /tmp/scene.yaml || fail "import arm.urdf"
  [[ -s $root/tmp/scene.yaml ]] || fail "import has written nothing"
fi

if compgen -G "$root/packages/python3-aurasim_*.deb" >/dev/null; then
  stage "driven by a program"
  apt install --no-install-recommends "/packages/$(cd "$root/packages" && ls libaurasim-dev_*.deb)" \
    "/packages/$(cd "$root/packages" && ls python3-aurasim_*.deb)"
  brings "$before_kib"
  as_user bash -c 'cd && python3 /usr/share/doc/aurasim/examples/lockstep.py' || fail "lockstep.py"
  [[ -f $root/usr/include/aurasim/client.h && -L $root/usr/lib/libaurasim_client.so ]] || fail "libaurasim-dev"
  apt install --no-install-recommends cmake g++ make
  as_user bash -c 'cd && cp -r /usr/share/doc/aurasim/examples . &&
    cmake -S examples -B examples/build >/dev/null && cmake --build examples/build && examples/build/lockstep' || fail "lockstep.cpp"
  apt purge cmake g++ make
fi

stage "installed once more: what the host's owner has written stays"
echo "LAUNCH=tower" >"$root/etc/aurasim/node.env"
apt install --reinstall --no-install-recommends "/packages/$(cd "$root/packages" && ls aurasim_*.deb)"
[[ $(cat "$root/etc/aurasim/node.env") == LAUNCH=tower ]] || fail "an upgrade has overwritten node.env"

stage "removed"
apt remove aurasim
[[ ! -e $root/usr/bin/aurasim && ! -e $root/usr/share/aurasim ]] || fail "the program is still there"
[[ -f $root/etc/aurasim/node.env && -d $root/var/lib/aurasim/report ]] || fail "remove took what belongs to the host's owner"

stage "purged"
rm -f "$root/tmp/scene.yaml"
# What has no files of the host's owner is gone by now, with what it needs: apt does not know its name any more.
mapfile -t known < <(online dpkg-query --show --showformat '${Package}\n' '*aurasim*')
apt purge "${known[@]}"
apt autoremove --purge
inventory >"$work/after"
diff "$work/before" "$work/after" || fail "something stays behind, or is gone"
echo "passed"
