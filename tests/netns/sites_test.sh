#!/usr/bin/env bash
# Three sites of hosts, each with a hub (dds.discovery: neighbours): only the hubs know each other, a router connects the
# sites, and no multicast passes it. Against one node in one process: no body lost or doubled, and the same bits, also
# when a hub is killed, and when a node is. Nothing of it is on the machine's own network. Exit code 77 where there can be
# no such laboratory. Domains 188, 189.
#   tests/netns/sites_test.sh short|long [NODES [STEPS]]     nodes on each site, 4 by default
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

mode=${1:?short or long} nodes=${2:-4} steps=${3:-600}
sites=3
aurasim=${AURASIM:-$PWD/build/release/aurasim}
lab=aurasites$$
reports=$(mktemp -d)
launch=launch_configs/demo.yaml
regions=$((sites * nodes))
declare -A pids hubs
same=(--set time.sync=deterministic)
cut=(--set "regions={layout: columns, count: $regions, width: $((72 / regions))}") # regions that listen to the next ones

skip() { echo "skipped: $1"; exit 77; }
fail() {
  echo "FAILED: $1"
  tail -n 30 "$reports"/*.log 2>/dev/null
  exit 1
}

# SITE HOST: hosts of a site count from 1; 100 is the hub, 254 the router.
address() { echo "10.81.$1.$2"; }
ns() { echo "$lab-$1-$2"; }
hub_address() { address "$1" 100; }

down() {
  local name
  kill -KILL "${pids[@]}" "${hubs[@]}" 2>/dev/null || true
  for name in $(ip netns list | awk '{ print $1 }' | grep "^$lab-"); do ip netns delete "$name"; done
  rm -rf "$reports"
}

add_host() {
  local site=$1 host=$2 name
  name=$(ns "$site" "$host")
  ip netns add "$name"
  ip -n "$name" link set lo up
  ip link add "p$site.$host" netns "$lab-router" type veth peer name eth0 netns "$name"
  ip -n "$lab-router" link set "p$site.$host" master "site$site" up
  ip -n "$name" address add "$(address "$site" "$host")/24" dev eth0
  ip -n "$name" link set eth0 up
  ip -n "$name" route add default via "$(address "$site" 254)"
}

up() {
  local site host
  ip netns add "$lab-router" || return 1
  ip netns exec "$lab-router" sysctl -qw net.ipv4.ip_forward=1 || return 1
  for ((site = 0; site < sites; ++site)); do
    ip -n "$lab-router" link add "site$site" type bridge
    ip -n "$lab-router" address add "$(address "$site" 254)/24" dev "site$site"
    ip -n "$lab-router" link set "site$site" up
    for ((host = 1; host <= nodes; ++host)); do add_host "$site" "$host" || return 1; done
    add_host "$site" 100 || return 1
  done
}

# SITE HOST NAME COMMAND [OPTION...]: starts the program there, its output in NAME.log
on_host() {
  local site=$1 host=$2 name=$3 command
  read -ra command <<<"$4"
  shift 4
  ip netns exec "$(ns "$site" "$host")" "$aurasim" "${command[@]}" "$launch" "${same[@]}" "${cut[@]}" --set dds.domain=189 \
    --set "dds.profiles=$profiles" --set dds.discovery=neighbours --set "dds.interfaces=[$(address "$site" "$host")]" \
    --set "dds.hub=$(hub_address "$site")" "$@" >"$reports/$name.log" 2>&1 &
}

start_hub() {
  local site=$1 other peers=''
  for ((other = 0; other < sites; ++other)); do
    [[ $other == "$site" ]] || peers+=${peers:+, }$(hub_address "$other")
  done
  on_host "$site" 100 "hub$site" hub --set "dds.peers=[$peers]"
  hubs[$site]=$!
}

kill_hub() {
  kill -KILL "${hubs[$1]}"
  wait "${hubs[$1]}" 2>/dev/null || true
  unset "hubs[$1]"
}

# REPORT [OPTION...]: hubs and a node on each host; region R is on site R / NODES
start() {
  local report=$1 region site
  shift
  rm -f "$reports"/*.log
  pids=()
  for ((site = 0; site < sites; ++site)); do start_hub "$site"; done
  for ((region = 0; region < regions; ++region)); do
    on_host $((region / nodes)) $((region % nodes + 1)) "node$region" node --region "$region" --steps "$steps" \
      --report "$reports/$report" "$@"
    pids[$region]=$!
  done
}

# REPORT ROWS: waits until all regions have written so many states
wait_for_states() {
  local region deadline=$((SECONDS + 120))
  for ((region = 0; region < regions; ++region)); do
    until [[ $({ wc -l <"$reports/$1/region_$region/steps.csv"; } 2>/dev/null) -gt $2 ]]; do
      [[ $SECONDS -lt $deadline ]] || fail "$1: the run does not get to state $2"
      sleep 0.05
    done
  done
}

# REPORT [REGION]: waits until all have ended; that of REGION has been killed
finish() {
  local report=$1 site
  end "$@"
  ! grep -h 'Assertion' "$reports"/*.log || fail "$report: a process ended by an assertion"
  for site in "${!hubs[@]}"; do kill -0 "${hubs[$site]}" || fail "$report: hub $site has ended"; done
  for site in "${!hubs[@]}"; do kill_hub "$site"; done
  "$aurasim" report "$launch" "$reports/$report" "${same[@]}" "${cut[@]}" || fail "$report: a body is lost or doubled"
  "$aurasim" compare "$reports/central" "$reports/$report" || fail "$report: other bits"
}

end() {
  local report=$1 killed=${2:-none} region code deadline=$((SECONDS + 180))
  for region in "${!pids[@]}"; do
    while kill -0 "${pids[$region]}" 2>/dev/null; do
      [[ $SECONDS -lt $deadline ]] || fail "$report: process $region does not end"
      sleep 0.1
    done
    code=0
    wait "${pids[$region]}" || code=$?
    [[ $code -eq 0 || $region == "$killed" ]] || fail "$report: process $region ended with exit code $code"
  done
  pids=()
}

start_spare() {
  on_host "$1" "$nodes" spare spare "${@:2}"
  pids[spare]=$!
}

[[ $EUID -eq 0 ]] || skip "needs root"
command -v ip >/dev/null || skip "there is no ip"
trap down EXIT
up || skip "cannot make network namespaces"

"$aurasim" launch $launch --headless --steps "$steps" --report "$reports/central" "${same[@]}" \
  --set regions.count=1 --set time.pace=none --set dds.domain=188 >/dev/null


# Nothing of a run says that a node has died.
nobody_died() {
  ! grep -lE 'has died|silent|takes over|cut off' "$reports"/*.log || fail "$1: somebody counts as dead"
}

hub_is_killed() {
  echo "-- a hub is killed"
  start hub_killed
  wait_for_states hub_killed 60
  kill_hub 1
  finish hub_killed
  nobody_died hub_killed
}

hub_and_node_are_killed() {
  local died=$((2 * nodes - 1)) more=(--set survival.checkpoint=0.5)
  echo "-- a hub is killed, and then a node of its site"
  start node_killed "${more[@]}"
  start_spare 2 "${more[@]}" --report "$reports/node_killed" --steps "$steps"
  wait_for_states node_killed 60
  kill_hub 1
  sleep 6 # longer than it takes to notice a silence
  nobody_died node_killed
  kill -KILL "${pids[$died]}"
  finish node_killed "$died"
  grep -q "spare: takes over region $died" "$reports/spare.log" || fail "the spare did not take region $died over"
}

all_hubs_are_killed() {
  local died=$((nodes - 1)) site more=(--set survival.checkpoint=0.5)
  echo "-- all hubs are killed; they come back, and a node is killed"
  start hubs_back "${more[@]}"
  start_spare 2 "${more[@]}" --report "$reports/hubs_back" --steps "$steps"
  wait_for_states hubs_back 60
  for ((site = 0; site < sites; ++site)); do kill_hub $site; done
  sleep 6
  nobody_died hubs_back
  kill -KILL "${pids[$died]}"
  sleep 1
  for ((site = 0; site < sites; ++site)); do start_hub $site; done
  finish hubs_back "$died"
  grep -q "spare: takes over region $died" "$reports/spare.log" || fail "the spare did not take region $died over"
}

# SITE HOST up|down
link() { ip -n "$lab-router" link set "p$1.$2" "$3"; }

hubs_are_cut_off() {
  local site
  echo "-- the hosts of all hubs are cut off for longer than the lease, and come back"
  start hubs_cut
  wait_for_states hubs_cut 60
  for ((site = 0; site < sites; ++site)); do link $site 100 down; done
  sleep 5
  for ((site = 0; site < sites; ++site)); do link $site 100 up; done
  finish hubs_cut
  nobody_died hubs_cut
}

site_is_cut_off() {
  echo "-- a site is cut off for longer than the lease, and comes back"
  start site_cut --set survival.checkpoint=0.5
  wait_for_states site_cut 60
  ip -n "$lab-router" link set site1 down
  sleep 8
  ip -n "$lab-router" link set site1 up
  finish site_cut
}

is_steered() {
  local steps=100000 site
  echo "-- a run is watched from one site, and stopped from another one"
  start steered
  wait_for_states steered 60
  on_host 2 1 top top --duration 3
  wait $! || fail "steered: top"
  [[ $(grep -c running "$reports/top.log") -ge $regions ]] || fail "steered: top does not see all"
  on_host 1 1 stop "send stop"
  wait $! || fail "steered: send stop"
  end steered
  for site in "${!hubs[@]}"; do kill_hub "$site"; done
  "$aurasim" report "$launch" "$reports/steered" "${same[@]}" "${cut[@]}" || fail "steered: a body is lost or doubled"
}

# Leases of 10 s, and of 3 s; a hub's silence about a node is believed after 15.5 s and 5 s.
profiles=$PWD/qos/hosts.xml
sed -e 's|<lease_duration><sec>10<|<lease_duration><sec>3<|; s|<leaseDuration><sec>10<|<leaseDuration><sec>3<|' \
  -e 's|<announcement_period><sec>2<|<announcement_period><sec>0<|' "$profiles" >"$reports/hosts.xml"
ln -s "$PWD/qos/aurasim.xml" "$reports/aurasim.xml"
short_leases=$reports/hosts.xml
case $mode in
  short)
    hub_is_killed
    profiles=$short_leases
    hub_and_node_are_killed
    ;;
  long)
    hub_is_killed
    profiles=$short_leases
    hub_and_node_are_killed
    all_hubs_are_killed
    is_steered
    hubs_are_cut_off
    site_is_cut_off
    ;;
  *) # one of them
    profiles=$short_leases
    "$mode"
    ;;
esac
echo "passed"
