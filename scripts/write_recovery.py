#!/usr/bin/python3
"""Writes docs/recovery.md from what scripts/recovery.sh has left.

    scripts/write_recovery.py DIR [--out docs]
"""
import argparse
import json
import pathlib
import statistics

from report_parts import machine_line, measured_line, table

TEXT = """# Nodes that die: measured

{measured}

Written by `scripts/recovery.sh`; do not edit. {machine}.

Real processes over DDS on one host: the demo (four nodes, `deterministic`, {steps} states, paced by the clock), whose nodes are
killed (`kill -9`) at random, any of them, some within the recovery of another, beside new regions, drains and orders of
clients. Every later state's hash has to be that of the same run, with the same orders, that nobody disturbed; no body may be
lost or be there twice. *Back*: from the kill until every node has gone back and computes; *states*: how many are computed
again.

{sums}
{misses}
## What it costs a healthy run

{rounds} runs of each kind by turns, without anybody dying: `survival.on_death: go_on`, where no parts are kept, against `recover`
with a part every second. Medians; frames of all nodes.

{costs}"""


def percentile(values, share):
    values = sorted(values)
    return values[min(len(values) - 1, int(share * len(values)))] if values else float("nan")


def sum_row(kind, runs):
    deaths = [death for run in runs for death in run["deaths"]]
    times = [death["s"] for death in deaths if death["s"] is not None]
    killed = sum(len(death["regions"]) for death in deaths)
    return [{"single": "one, or two shortly after each other", "pairs": "two at once"}[kind], len(runs), len(deaths), killed,
            sum(run["orders"] for run in runs), sum(run["drains"] for run in runs),
            sum(1 for run in runs if run["equal"]), sum(run["bodies_lost"] or 0 for run in runs),
            sum(run["bodies_duplicated"] or 0 for run in runs), f"{percentile(times, 0.5):.2f}",
            f"{percentile(times, 0.95):.2f}", f"{max(times, default=float('nan')):.2f}",
            sum(1 for death in deaths if death["state"] == 0), len(deaths) - len(times)]


def miss_lines(runs):
    lines = []
    for run in runs:
        if not run["equal"] or run["exit"] != 0:
            lines.append(f"- {run['kind']}, seed {run['seed']}: equal: {run['equal']}, exit code {run['exit']}")
        lines += [f"- {run['kind']}, seed {run['seed']}: refused: {text}" for text in run["refused"]]
    return "\n".join(["Misses:", "", *lines, ""]) if lines else "No misses.\n"


def cost_rows(rows):
    result = []
    for scene in sorted({row["scene"] for row in rows}):
        cells = [scene]
        medians = {}
        for rule in ("go_on", "recover"):
            of_rule = [row for row in rows if row["scene"] == scene and row["rule"] == rule]
            medians[rule] = {key: statistics.median(row[key] for row in of_rule) for key in ("p50", "p99")}
            cells += [f"{medians[rule]['p50']:.2f}", f"{medians[rule]['p99']:.2f}"]
            if rule == "recover":
                seconds = of_rule[0]["seconds"]
                sent = statistics.median(row["aura_bytes"] for row in of_rule) / seconds / 1e3
                kept = statistics.median(row["bytes"] for row in of_rule) / seconds / 1e3
        cells += [f"{100 * (medians['recover']['p99'] / medians['go_on']['p99'] - 1):+.0f}%", f"{sent:.1f}", f"{kept:.1f}"]
        result.append(cells)
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("directory", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("docs"))
    options = parser.parse_args()
    runs = [json.loads(line) for line in (options.directory / "runs.jsonl").read_text().splitlines()]
    costs = [json.loads(line) for line in (options.directory / "cost.jsonl").read_text().splitlines()]
    sums = table(["deaths", "runs", "deaths", "nodes killed", "orders", "drains", "runs equal", "bodies lost", "twice",
                  "back p50, s", "p95", "max", "from state 0", "not back"],
                 [sum_row(kind, [r for r in runs if r["kind"] == kind]) for kind in ("single", "pairs")
                  if any(r["kind"] == kind for r in runs)])
    text = TEXT.format(measured=measured_line(options.directory), machine=machine_line(), sums=sums,
                       steps=max(r["steps"] or 0 for r in runs), misses=miss_lines(runs), rounds=len(costs) // 4,
                       costs=table(["scene", "without: frame p50, ms", "p99", "with: p50", "p99", "p99 with to without",
                                    "sent to neighbours, kB/s", "to keepers, kB/s"], cost_rows(costs)))
    (options.out / "recovery.md").write_text(text)


if __name__ == "__main__":
    main()
