#!/usr/bin/env bash
# A laboratory of separate hosts on one machine: one network namespace per host, each with one link to a switch (a bridge
# in a namespace of its own). Needs root. Nothing of it is on the machine's own network.
#   scripts/netns_lab.sh up N               N hosts, 10.73.0.1 to 10.73.0.N; "switch" is one more, 10.73.0.254
#   scripts/netns_lab.sh down               ends what runs in them and removes them
#   scripts/netns_lab.sh status             hosts, links, impairments, and what this kernel can impair
#   scripts/netns_lab.sh impair [loss=PERCENT] [rate=RATE] [delay=TIME]   of every host; no argument: none any more
#   scripts/netns_lab.sh cut HOST | restore HOST                          its link (hosts count from 0)
#   scripts/netns_lab.sh run LAUNCH [--duration S] [--report DIR] [--cut HOST@AT+FOR] [--discovery multicast|peers|server]
#                            [--regions N] [--set KEY=VALUE ...]   one node on each host; with --report also the merged
#                            report. --cut: AT seconds after the host's node began, for FOR seconds ("HOST@AT": for good);
#                            --deaf, --mute: likewise, but only what comes to the host, or only what it sends, is lost.
#                            --regions: hosts from N on have spares
#   scripts/netns_lab.sh aurasim HOST|switch COMMAND LAUNCH [OPTION ...]  top, send, echo, overseer ... on a host
#   scripts/netns_lab.sh on HOST|switch COMMAND ...                       anything, e.g. tshark
# AURASIM_LAB: prefix of the namespaces' names (default auralab), for several laboratories at a time.
# AURASIM: the program (default build/release/aurasim).
# Exit codes of run: 0 all well, 1 a node failed or a body is lost or doubled, 2 wrong usage.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
lab=${AURASIM_LAB:-auralab}
aurasim=${AURASIM:-$root/build/release/aurasim}
switch=$lab-switch
subnet=10.73.0

fail() {
  printf 'netns_lab.sh: %s\n' "$1" >&2
  exit "${2:-1}"
}
usage() {
  sed -n '2,/^set -/{/^#/s/^# \{0,1\}//p}' "${BASH_SOURCE[0]}" >&2
  exit 2
}

ns() { if [[ $1 == switch ]]; then echo "$switch"; else echo "$lab-$1"; fi; }
address() { if [[ $1 == switch ]]; then echo $subnet.254; else echo "$subnet.$(($1 + 1))"; fi; }
exists() { [[ -e /run/netns/$(ns "$1") ]]; }
hosts() {
  local i
  for ((i = 0; i < 250; ++i)); do
    exists "$i" || break
    echo "$i"
  done
}
need_host() { exists "$1" || fail "there is no host $1; 'netns_lab.sh up N' makes some" 2; }

add_host() {
  local host=$1
  ip netns add "$(ns "$host")"
  ip -n "$(ns "$host")" link set lo up
  ip link add "port$host" netns "$switch" type veth peer name eth0 netns "$(ns "$host")"
  ip -n "$switch" link set "port$host" master bridge up
  ip -n "$(ns "$host")" address add "$(address "$host")/24" dev eth0
  ip -n "$(ns "$host")" link set eth0 up
  ip -n "$(ns "$host")" route add default dev eth0 # discovery's multicast needs a way out
}

up() {
  [[ ${1:-} =~ ^[1-9][0-9]?$ ]] || usage
  [[ ! -e /run/netns/$switch ]] || fail "the laboratory '$lab' is up already"
  trap 'down; echo "netns_lab.sh: up: could not make the namespaces" >&2' EXIT
  ip netns add "$switch"
  ip -n "$switch" link set lo up
  # Without snooping multicast goes to all, as on a plain switch.
  ip -n "$switch" link add bridge type bridge mcast_snooping 0
  ip -n "$switch" address add "$(address switch)/24" dev bridge
  ip -n "$switch" link set bridge up
  ip -n "$switch" route add default dev bridge
  local host
  for ((host = 0; host < $1; ++host)); do add_host "$host"; done
  trap - EXIT
}

end_processes_in() {
  local name=$1 signal pid
  for signal in TERM KILL; do
    for pid in $(ip netns pids "$name"); do kill -"$signal" "$pid" 2>/dev/null || true; done
    for _ in {1..20}; do
      [[ -n $(ip netns pids "$name") ]] || return 0
      sleep 0.1
    done
  done
}

down() {
  local host name
  for host in $(hosts) switch; do
    name=$(ns "$host")
    [[ -e /run/netns/$name ]] || continue
    end_processes_in "$name"
    ip netns delete "$name"
  done
}

# netem, tbf, nft: tried in a namespace that is gone afterwards.
kernel_offers() {
  local probe=$lab-probe$$ offers=1
  ip netns add "$probe"
  case $1 in
    netem) ip netns exec "$probe" tc qdisc add dev lo root netem delay 1ms ;;
    tbf) ip netns exec "$probe" tc qdisc add dev lo root tbf rate 1mbit burst 32k latency 50ms ;;
    nft) ip netns exec "$probe" nft -f - <<<"$(drop_rules 1)" ;;
  esac >/dev/null 2>&1 && offers=0
  ip netns delete "$probe"
  return $offers
}

# Dropped where they come in: dropped on the way out, the sender would be told.
drop_rules() {
  printf 'table inet auralab {\n chain input {\n  type filter hook input priority 0;\n'
  printf '  meta l4proto udp numgen random mod 1000 < %d counter drop\n }\n}\n' "$(awk "BEGIN { print int(10 * $1 + 0.5) }")"
}

unimpair() {
  ip netns exec "$(ns "$1")" tc qdisc delete dev eth0 root 2>/dev/null || true
  ip netns exec "$(ns "$1")" nft delete table inet auralab 2>/dev/null || true
}

impair() {
  local setting loss='' rate='' delay='' host
  for setting in "$@"; do
    [[ $setting =~ ^(loss|rate|delay)=(.+)$ ]] || usage
    printf -v "${BASH_REMATCH[1]}" '%s' "${BASH_REMATCH[2]%\%}"
  done
  need_host 0
  for host in $(hosts); do unimpair "$host"; done
  [[ -n $loss$rate$delay ]] || return 0
  if kernel_offers netem; then
    for host in $(hosts); do
      ip netns exec "$(ns "$host")" tc qdisc add dev eth0 root netem \
        ${delay:+delay "$delay"} ${loss:+loss "$loss%"} ${rate:+rate "$rate"}
    done
    echo "impaired by tc netem"
    return
  fi
  [[ -z $delay ]] || fail "this kernel has no netem, so no delay; give the nodes --set dds.impair.delay=SECONDS"
  for host in $(hosts); do
    [[ -z $rate ]] || ip netns exec "$(ns "$host")" tc qdisc add dev eth0 root tbf rate "$rate" burst 32k latency 200ms
    [[ -z $loss ]] || ip netns exec "$(ns "$host")" nft -f - <<<"$(drop_rules "$loss")"
  done
  echo "impaired by${rate:+ tc tbf (rate)}${loss:+ nftables (loss)}; this kernel has no netem"
}

link() {
  need_host "$1"
  ip -n "$switch" link set "port$1" "$2"
}

status() {
  local kind host
  for kind in netem tbf nft; do
    if kernel_offers "$kind"; then echo "kernel: $kind"; else echo "kernel: no $kind"; fi
  done
  for host in $(hosts); do
    printf 'host %s: %s, link %s, %s processes; %s\n' "$host" "$(address "$host")" \
      "$(ip -n "$switch" -o link show "port$host" | grep -qw UP && echo up || echo cut)" \
      "$(ip netns pids "$(ns "$host")" | wc -l)" "$(impairments_of "$host")"
  done
  exists 0 || echo "no hosts"
}

impairments_of() {
  local name
  name=$(ns "$1")
  {
    ip netns exec "$name" tc qdisc show dev eth0 | grep -Ew 'netem|tbf' || true
    ip netns exec "$name" nft list ruleset 2>/dev/null | grep -w drop || true
  } | tr -s ' \t\n' ' ' | grep . || echo "not impaired"
}

# What makes the launch file right for a host: its address, the profiles of separate hosts, how it finds the others.
flags_of() {
  local host=$1 discovery=${2:-multicast} peers='' other
  printf '%s\n' --set "dds.profiles=$root/qos/hosts.xml" --set "dds.interfaces=[$(address "$host")]"
  case $discovery in
    multicast) return ;;
    server) peers=$(address switch) ;;
    peers)
      for other in $(hosts); do
        [[ $other == "$host" ]] || peers+=${peers:+, }$(address "$other")
      done
      ;;
    *) usage ;;
  esac
  printf '%s\n' --set "dds.discovery=$discovery" --set "dds.peers=[$peers]"
}

run_on() {
  local host=$1
  shift
  need_host "$host"
  exec ip netns exec "$(ns "$host")" "$@"
}

# shellcheck source=scripts/netns_run.sh
source "$root/scripts/netns_run.sh"

[[ $EUID -eq 0 ]] || fail "needs root"
command=${1:-}
shift $(($# > 0))
case $command in
  up) up "$@" ;;
  down) down ;;
  status) status ;;
  impair) impair "$@" ;;
  cut) link "${1:?}" down ;;
  restore) link "${1:?}" up ;;
  run) run "$@" ;;
  aurasim)
    [[ $# -ge 3 ]] || usage
    mapfile -t flags < <(flags_of "$1")
    run_on "$1" "$aurasim" "${@:2}" "${flags[@]}"
    ;;
  on) run_on "$@" ;;
  *) usage ;;
esac
