#!/usr/bin/env bash
# The scene of the README, as its reader types it: written, checked, run on two nodes and on one, compared.
#   tests/docs/readme_scene_test.sh AURASIM
set -euo pipefail
readme=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)/README.md
aurasim=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# A DDS domain that no other test has: leased as in tests/own_domain.h.
leases=${TMPDIR:-/tmp}/aurasim_test_domains
mkdir -p "$leases"
for domain in $(shuf -i 2-101); do
  exec {lease}>>"$leases/$domain"
  flock -n "$lease" && break
  exec {lease}>&-
done

# The block of code that begins with LINE.
block() {
  awk -v first="$1" '
    /^```/ { inside = !inside; taken = 0; next }
    inside && !taken && index($0, first) == 1 { taken = 1 }
    inside && taken { print }' "$readme"
}
mapfile -t lines < <(block "mkdir -p mine")
((${#lines[@]} > 20)) || { echo "the README has no scene any more"; exit 1; }
command=${lines[-1]}
[[ $command == "build/release/aurasim launch mine/launch.yaml" ]] || { echo "the last line is: $command"; exit 1; }
unset 'lines[-1]'
bash -euo pipefail <(printf '%s\n' "${lines[@]}")
scene_lines=$(wc -l <mine/scene.yaml)
((scene_lines <= 15)) || { echo "the scene has $scene_lines lines"; exit 1; }

"$aurasim" check mine/launch.yaml
comparison=$(block "build/release/aurasim launch mine/launch.yaml --headless")
comparison=${comparison//build\/release\/aurasim/'"$aurasim"'}
comparison=${comparison// launch mine\/launch.yaml/ launch mine/launch.yaml --set dds.domain=$domain}
comparison=${comparison//\/tmp\//"$work"/}
export aurasim
said=$(bash -euo pipefail <(echo "$comparison"))
echo "$said"
tail -n 1 <<<"$said" | grep -qxF "$(block equal:)"
handed_over=$(grep -c ',out,' two/migrations.csv || true)
echo "bodies handed over between the two nodes: $handed_over"
((handed_over > 0))
