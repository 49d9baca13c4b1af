# Sourced by netns_lab.sh: one node per host, a link that is cut and restored meanwhile, and the merged report.
# shellcheck shell=bash

node_pids=()
helper_pids=()

end_run() {
  local pid
  for pid in "${node_pids[@]}" "${helper_pids[@]}"; do kill "$pid" 2>/dev/null || true; done
}

# HOST@AT+FOR or HOST@AT; how: cut, deaf or mute
cut_in_time() {
  local report=$1 how=$2 plan=$3
  [[ $plan =~ ^([0-9]+)@([0-9.]+)(\+([0-9.]+))?$ ]] || usage
  local host=${BASH_REMATCH[1]} at=${BASH_REMATCH[2]} for=${BASH_REMATCH[4]}
  until [[ -e $report/region_$host/steps.csv ]]; do sleep 0.05; done
  sleep "$at"
  separate "$how" "$host"
  echo "$(date +%T) host $host is cut off ($how)" >&2
  [[ -n $for ]] || return 0
  sleep "$for"
  rejoin "$how" "$host"
  echo "$(date +%T) host $host is back" >&2
}

separate() {
  case $1 in
    cut) link "$2" down ;;
    deaf) refuse_from "$2" 0.0.0.0/0 ;;
    mute) for_others "$2" refuse_from "$(address "$2")" ;;
  esac
}

rejoin() {
  case $1 in
    cut) link "$2" up ;;
    deaf) accept_all "$2" ;;
    mute) for_others "$2" accept_all ;;
  esac
}

# HOST FUNCTION ARGUMENT...: the function for each other host
for_others() {
  local host=$1 other
  for other in $(hosts) switch; do
    [[ $other == "$host" ]] || "$2" "$other" "${@:3}"
  done
}

# What comes to the first from the second is dropped where it comes in. Loopback stays.
refuse_from() {
  ip netns exec "$(ns "$1")" nft -f - <<<"table inet auracut {
 chain input {
  type filter hook input priority 0;
  iifname != \"lo\" ip saddr $2 meta l4proto udp drop
 }
}"
}

accept_all() { ip netns exec "$(ns "$1")" nft delete table inet auracut; }

# It would use shared memory, too, and leave it behind: it gets one of its own (ip netns exec has its own mounts).
start_server() {
  # shellcheck disable=SC2016
  ip netns exec "$(ns switch)" bash -c 'mount -t tmpfs none /dev/shm && exec fast-discovery-server -i 0 -l "$0" -p 11811' \
    "$(address switch)" >/dev/null &
  helper_pids+=($!)
}

start_nodes() {
  local launch=$1 host flags role
  shift
  for host in $(hosts); do
    mapfile -t flags < <(flags_of "$host" "$discovery")
    role=(node "$launch" --region "$host")
    [[ -z $regions || $host -lt $regions ]] || role=(spare "$launch")
    ip netns exec "$(ns "$host")" "$aurasim" "${role[@]}" "${flags[@]}" "$@" &
    node_pids+=($!)
  done
}

# Waits for all; tells whose exit code is not 0.
collect_nodes() {
  local host code worst=0
  for host in "${!node_pids[@]}"; do
    code=0
    wait "${node_pids[$host]}" || code=$?
    [[ $code -eq 0 ]] || { echo "the node of region $host ended with exit code $code"; worst=1; }
  done
  return $worst
}

run() {
  local launch=${1:?} report='' plan='' how='' regions='' discovery=multicast ok=0 options=() settings=()
  shift
  while [[ $# -gt 0 ]]; do
    case $1 in
      --report) report=$2 ;;
      --cut | --deaf | --mute) how=${1#--} plan=$2 ;;
      --regions) regions=$2 ;;
      --discovery) discovery=$2 ;;
      --duration | --steps | --start-time-out) options+=("$1" "$2") ;;
      --set) settings+=(--set "$2") ;;
      *) usage ;;
    esac
    shift 2
  done
  need_host 0
  [[ -z $plan || -n $report ]] || fail "--$how counts from the node's first record: give --report" 2
  if [[ -n $report ]]; then
    rm -rf "$report"/region_* # of an earlier run
    options+=(--report "$report")
  fi
  trap end_run EXIT
  [[ $discovery != server ]] || start_server
  start_nodes "$launch" "${options[@]}" "${settings[@]}"
  if [[ -n $plan ]]; then
    cut_in_time "$report" "$how" "$plan" &
    helper_pids+=($!)
  fi
  collect_nodes || ok=1
  [[ -z $report ]] || "$aurasim" report "$launch" "$report" "${settings[@]}" || ok=1
  return $ok
}
