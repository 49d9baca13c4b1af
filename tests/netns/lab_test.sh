#!/usr/bin/env bash
# Nodes on separate hosts (scripts/netns_lab.sh) against one node in one process: no body lost or doubled, the same bits,
# with lost datagrams and with a link that is cut. Exit code 77 where there can be no such laboratory. Domains 184, 185.
#   tests/netns/lab_test.sh short|long|survive     about 50 s; 3 minutes; 4 minutes
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

export AURASIM=${AURASIM:-$PWD/build/release/aurasim} AURASIM_LAB=auratest$$
reports=$(mktemp -d)
trap 'scripts/netns_lab.sh down; rm -rf "$reports"' EXIT
launch=launch_configs/corner_stacks.yaml

skip() { echo "skipped: $1"; exit 77; }
[[ $EUID -eq 0 ]] || skip "needs root"
for tool in ip tc nft; do command -v $tool >/dev/null || skip "there is no $tool"; done
scripts/netns_lab.sh up 4 || skip "cannot make network namespaces"
scripts/netns_lab.sh status | grep -x 'kernel: nft' >/dev/null || skip "this kernel cannot drop datagrams at random"

fail() { echo "FAILED: $1"; exit 1; }

field() { jq -r "$2" "$reports/$1/summary.json"; }

central() {
  "$AURASIM" launch $launch --headless --duration "$1" --report "$reports/central" --set regions.count=1 \
    --set time.sync=deterministic --set time.pace=none --set dds.domain=184 >/dev/null
}

# NAME OPTION...: a run on the four hosts that must have the bits of the central one
same_as_central() {
  local name=$1
  shift
  echo "-- $name"
  scripts/netns_lab.sh run $launch --duration "$duration" --report "$reports/$name" --set dds.domain=185 \
    --set time.sync=deterministic "$@" || fail "$name: a node failed, or a body is lost or doubled"
  [[ $(field "$name" .migrations) -gt 50 ]] || fail "$name: hardly any hand-offs"
  "$AURASIM" compare "$reports/central" "$reports/$name" || fail "$name: other bits"
}

# Leases of 1 s (qos/aurasim.xml), a cut of 4 s, and nobody who takes the region over: all hosts end by name.
cut_longer_than_lease() {
  local name=long_cut host=$1 said
  echo "-- $name"
  said=$(scripts/netns_lab.sh run $launch --duration 7 --report "$reports/$name" --set dds.domain=185 \
    --set "dds.profiles=$PWD/qos/aurasim.xml" --set survival.on_death=stop --cut "$host@1.5+4" 2>&1) && fail "$name: nothing was noticed"
  echo "$said"
  for region in 0 1 2 3; do
    grep -q "region $region: the run ends in state" <<<"$said" || fail "$name: host $region did not say why it ends"
  done
  [[ $(field "$name" '.bodies_lost + .bodies_duplicated') == 0 ]] || fail "$name: bodies lost or doubled"
  [[ $(field "$name" '.bodies_alive + .bodies_with_dead_regions - .bodies_spawned') == 0 ]] || fail "$name: no account"
  [[ $(field "$name" '[.nodes[] | select(.outcome == "broken off")] | length') == 4 ]] || fail "$name: a host went on"
  # It computed nothing alone: no state later than what the others had sent before the cut allows.
  [[ $(field "$name" ".nodes[$host].steps") -lt 150 ]] || fail "$name: host $host simulated a world of its own"
}

# Leases of 1 s, a host with a spare. Host HOST is lost to the others for so long that the spare takes its region over; then
# it is back, as a spare. Nothing is lost, and every state has the bits of the central run.
#   survives NAME HOST HOW@AT+FOR
survives() {
  local name=$1 host=$2 how=${3%%@*} plan=$2@${3#*@} said
  echo "-- $name"
  said=$(scripts/netns_lab.sh run $launch --duration "$duration" --report "$reports/$name" --regions 4 \
    --set dds.domain=185 --set time.sync=deterministic --set "dds.profiles=$PWD/qos/aurasim.xml" \
    --set survival.checkpoint=0.5 "--$how" "$plan" 2>&1) || { echo "$said"; fail "$name: a node failed, or a body is lost or doubled"; }
  grep -q "spare: takes over region $host" <<<"$said" || { echo "$said"; fail "$name: the spare did not take region $host over"; }
  grep -q "region $host: comes back as a spare" <<<"$said" || { echo "$said"; fail "$name: host $host did not come back"; }
  "$AURASIM" compare "$reports/central" "$reports/$name" || fail "$name: other bits"
}

fifth_host() { scripts/netns_lab.sh down; scripts/netns_lab.sh up 5; }

case ${1:?short, long or survive} in
  short)
    duration=4
    central $duration
    scripts/netns_lab.sh impair loss=25
    same_as_central lossy_and_cut --cut 2@1.5+1.5
    scripts/netns_lab.sh impair
    cut_longer_than_lease 3
    fifth_host
    duration=12
    central $duration
    survives unplugged 3 cut@1.5+4
    ;;
  long)
    duration=30
    central $duration
    scripts/netns_lab.sh impair loss=10
    same_as_central lossy
    scripts/netns_lab.sh impair
    same_as_central cut --cut 2@5+5
    scripts/netns_lab.sh impair rate=50mbit
    same_as_central narrow
    scripts/netns_lab.sh impair
    duration=4
    central $duration
    same_as_central by_peers --discovery peers
    same_as_central by_server --discovery server
    cut_longer_than_lease 0
    ;;
  survive)
    fifth_host
    duration=40
    central $duration
    survives unplugged_region_0 0 cut@2+30
    survives deaf 1 deaf@2+15
    survives mute 2 mute@2+15
    ;;
esac
echo "passed"
