#!/usr/bin/env bash
# Installs what aurasim is built, run and tested with: packages of Debian 12. Run it as often as you like; when
# everything is there it changes nothing and takes no time.
#   scripts/setup.sh [--demo]     --demo: only what a world that runs needs, without what import, tests and experiments need
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

packages=(
  # compiler and build
  g++ cmake ninja-build
  # Fast DDS (its package brings Asio, OpenSSL, TinyXML2 and foonathan memory) and its IDL compiler, a Java program
  # whose package does not ask for Java
  libfastrtps-dev libfastcdr-dev fastddsgen default-jre-headless
  # physics, mathematics
  libbullet-dev libbullet-extras-dev libeigen3-dev
  # launch and scene files, meshes (assimp's CMake files name zlib, its package does not), command line, log, reports,
  # saved worlds
  libyaml-cpp-dev libassimp-dev zlib1g-dev libcli11-dev libspdlog-dev libfmt-dev nlohmann-json3-dev libzstd-dev
  # keys and certificates, TLS of the overseer
  libssl-dev
  # HTTP and WebSocket of the overseer, its page
  libboost1.74-dev esbuild
)
packages_of_import=(
  # other programs' models: SDF and URDF, MJCF, what neither says of XML
  libsdformat-dev libmujoco-dev libtinyxml2-dev
)
packages_of_python=(
  # the Python module, with numpy, and `pip install .` without network
  pybind11-dev python3-dev python3-numpy python3-pip python3-wheel python3-venv
)
packages_of_tests=(
  # second builds in seconds, the format check, the Debian package
  ccache clang-format dpkg-dev file
  # tests and benchmarks, and the tools that tests of real processes use
  libgtest-dev libgmock-dev libbenchmark-dev iproute2 procps tcpdump libfaketime
  # separate hosts on one machine; other people's DDS and a dissector, as witnesses
  nftables jq cyclonedds-dev cyclonedds-tools tshark
  # figures of the experiments
  python3-matplotlib
  # JSON schemas of launch and scene files, in tests
  python3-jsonschema python3-yaml
  # the browser that the page is tested in, the shell whose completion is tested
  chromium zsh
)

fail() {
  printf 'setup.sh: %s\n' "$*" >&2
  exit 1
}

case ${1:-} in
  '')
    packages+=("${packages_of_import[@]}" "${packages_of_python[@]}" "${packages_of_tests[@]}")
    # A node of another origin is as good (and brings an npm that Debian's would be in conflict with).
    command -v node >/dev/null || packages+=(nodejs)
    command -v npm >/dev/null || packages+=(npm)
    ;;
  --demo) ;;
  *) fail "found $1, allowed: --demo" ;;
esac

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  fail "this is not Debian. Install by other means what these packages of Debian 12 hold: ${packages[*]}"
fi

# Leaves out of the list what is installed. dpkg-query also fails when it does not know a package: that one is missing.
installed=$(dpkg-query --show --showformat '${Package} ${db:Status-Status}\n' "${packages[@]}" 2>/dev/null || true)
missing=()
for package in "${packages[@]}"; do
  grep -qxF "$package installed" <<<"$installed" || missing+=("$package")
done

install_missing() {
  local as_root=()
  if [[ $EUID -ne 0 ]]; then
    command -v sudo >/dev/null || fail "needs root or sudo, to install: ${missing[*]}"
    as_root=(sudo)
  fi
  local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o Acquire::Retries=3 -o DPkg::Lock::Timeout=300)
  printf 'setup.sh: installing %s\n' "${missing[*]}"
  "${apt[@]}" update
  "${apt[@]}" install --yes --no-install-recommends "${missing[@]}"
}

[[ ${#missing[@]} -eq 0 ]] || install_missing
[[ ${1:-} == --demo ]] && exit
# The tests of the page ask for it again, and fail by name when it still cannot be had: the others need not wait for it.
"$root/scripts/build_web.sh" --tests || printf 'setup.sh: no page, so the tests of it will fail\n' >&2
