#!/usr/bin/env bash
# run_test.sh LABORATORY: `run` appends rows, and a quick run says where it differs from the stored full one.
set -euo pipefail
lab=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "FAILED: $*" >&2; exit 1; }
rows=$work/accuracy.jsonl

"$lab" run accuracy --results "$work" >"$work/said" 2>/dev/null || fail "NothingStoredYetIsNoDifference: $(<"$work/said")"
# How many points lie on the front depends on CPU times, so their rows are not counted.
count() { grep -vcE '"case": ?"(front|others)/' "$rows"; }
first=$(count)
((first > 100)) || fail "ARunAppendsItsRows: $first rows"
! grep -q '"run":"full"' "$rows" || fail "AQuickRunIsCalledQuick"

# The same rows as those of a full run, with one error and all times larger by a fiftieth.
sed -i 's/"run":"quick"/"run":"full"/' "$rows"
/usr/bin/python3 - "$rows" <<'PY'
import json, sys
rows = [json.loads(line) for line in open(sys.argv[1])]
for row in rows:
    if (row["case"], row["metric"]) == ("spring/1_60 s", "distance from the sine") or row["metric"] == "CPU time of a step":
        row["value"] *= 1.02
open(sys.argv[1], "w").writelines(json.dumps(row) + "\n" for row in rows)
PY
code=0
"$lab" run accuracy --results "$work" >"$work/said" 2>/dev/null || code=$?
differ=$(grep '^DIFFERS' "$work/said" | grep -v 'CPU time' || true) # a busy machine may take half as long again
[[ $differ == "DIFFERS spring/1_60 s, distance from the sine:"* && $(wc -l <<<"$differ") == 1 ]] ||
  fail "AnErrorThatChangedIsNamed: $differ"
[[ $code != 0 ]] || fail "ADifferenceFails"
[[ $(count) == $((2 * first)) ]] || fail "ItsRowsAreStoredAllTheSame"
