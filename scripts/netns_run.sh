# Sourced by netns_lab.sh: one node per host, a link that is cut and restored meanwhile, and the merged report.
# shellcheck shell=bash

node_pids=()
helper_pids=()

end_run() {
  local pid
  for pid in "${node_pids[@]}" "${helper_pids[@]}"; do kill "$pid" 2>/dev/null || true; done
}

# HOST@AT+FOR or HOST@AT
cut_in_time() {
  local report=$1 plan=$2
  [[ $plan =~ ^([0-9]+)@([0-9.]+)(\+([0-9.]+))?$ ]] || usage
  local host=${BASH_REMATCH[1]} at=${BASH_REMATCH[2]} for=${BASH_REMATCH[4]}
  until [[ -e $report/region_$host/steps.csv ]]; do sleep 0.05; done
  sleep "$at"
  link "$host" down
  echo "$(date +%T) host $host is cut off" >&2
  [[ -n $for ]] || return 0
  sleep "$for"
  link "$host" up
  echo "$(date +%T) host $host is back" >&2
}

start_server() {
  ip netns exec "$(ns switch)" fast-discovery-server -i 0 -l "$(address switch)" -p 11811 >/dev/null &
  helper_pids+=($!)
}

start_nodes() {
  local launch=$1 host flags
  shift
  for host in $(hosts); do
    mapfile -t flags < <(flags_of "$host" "$discovery")
    ip netns exec "$(ns "$host")" "$aurasim" node "$launch" --region "$host" "${flags[@]}" "$@" &
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
  local launch=${1:?} report='' plan='' discovery=multicast ok=0 options=() settings=()
  shift
  while [[ $# -gt 0 ]]; do
    case $1 in
      --report) report=$2 ;;
      --cut) plan=$2 ;;
      --discovery) discovery=$2 ;;
      --duration | --steps | --start-time-out) options+=("$1" "$2") ;;
      --set) settings+=(--set "$2") ;;
      *) usage ;;
    esac
    shift 2
  done
  need_host 0
  [[ -z $plan || -n $report ]] || fail "--cut counts from the node's first record: give --report" 2
  if [[ -n $report ]]; then
    rm -rf "$report"/region_* # of an earlier run
    options+=(--report "$report")
  fi
  trap end_run EXIT
  [[ $discovery != server ]] || start_server
  start_nodes "$launch" "${options[@]}" "${settings[@]}"
  if [[ -n $plan ]]; then
    cut_in_time "$report" "$plan" &
    helper_pids+=($!)
  fi
  collect_nodes || ok=1
  [[ -z $report ]] || "$aurasim" report "$launch" "$report" "${settings[@]}" || ok=1
  return $ok
}
