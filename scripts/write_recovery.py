#!/usr/bin/python3
"""Writes docs/results.md#recovery from what scripts/recovery.sh has left.

    scripts/write_recovery.py DIR [--out docs]
"""
import argparse
import json
import pathlib
import statistics

from page_sections import put_section
from report_parts import machine_line, measured_line, table

TEXT = """## Recovery: nodes that die

{measured}

Written by `scripts/recovery.sh`; do not edit. {machine}.

Real processes over DDS on one host: the demo (four nodes, `deterministic`, {steps} states, paced by the clock), whose nodes are
killed (`kill -9`) at random, any of them, some within the recovery of another, beside new regions, drains and orders of
clients. Every later state's hash has to be that of the same run, with the same orders, that nobody disturbed; no body may be
lost or be there twice. *Back*: from the kill until every node has gone back and computes. *From state 0*: a node and the one that
kept its parts died within a moment; what clients had ordered before is not known any more, so those runs may differ.

{sums}
{misses}
{rolling}{soak}{endurance}### What it costs a healthy run

{rounds} runs of each kind by turns, without anybody dying: `survival.on_death: stop`, where no parts are kept, against `recover`
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


def read_lines(file):
    return [json.loads(line) for line in file.read_text().splitlines()] if file.exists() else []


def rolling_text(runs):
    """Every node in turn gives its region to a new process."""
    if not runs:
        return ""
    rows = []
    for run in runs:
        stood = [drain["stood_s"] for drain in run["drains"] if drain["stood_s"] is not None]
        rows.append([run["steps"], len(run["drains"]), sum(drain["ok"] for drain in run["drains"]),
                     f"{max(stood, default=float('nan')):.2f}", f"{run['real_time_factor'] or 0:.3f}",
                     "yes" if run["equal"] else "NO", run["bodies_lost"], run["bodies_duplicated"]])
    return ("### A rolling restart\n\n`send drain` of one region after the other (`scripts/recovery_rolling.py`): its node leaves when "
            "the launcher's new process is there. *Stood*: the longest time that the others stood for it.\n\n"
            + table(["states", "drains", "done", "stood, s", "real-time factor", "hashes as undisturbed", "bodies lost", "twice"],
                    rows))


def soak_text(runs):
    """Kills, drains and saves at random, all the time."""
    if not runs:
        return ""
    rows = []
    for run in runs:
        sizes = run["sizes"]
        at = lambda share: sizes[min(len(sizes) - 1, int(share * len(sizes)))]
        counts = run["counts"]
        rows.append([run["minutes"], run["steps"], counts["kills"], counts["drains"], counts["saves"],
                     "yes" if run["equal"] else "NO", run["bodies_lost"], run["bodies_duplicated"],
                     ", ".join(f"{at(share)[2] / 1024:.0f}" for share in (0.1, 0.5, 1.0)),
                     ", ".join(f"{at(share)[3] / 1024:.0f}" for share in (0.1, 0.5, 1.0))])
    return ("### A long run\n\nNodes are killed, drained and saved every 2 to 12 s (`scripts/recovery_rolling.py --soak MINUTES`); "
            "memory after a tenth, half and all of the time, of the largest node and of the launcher."
            + "".join(f" At commit {run['commit']}." for run in runs if "commit" in run) + "\n\n"
            + table(["minutes", "states", "kills", "drains", "saves", "hashes as undisturbed", "bodies lost", "twice",
                     "node, MiB", "launcher, MiB"], rows))


def endurance_text(lines):
    """A line for every simulated hour; the last one has the sums."""
    if not lines:
        return ""
    last = lines[-1]
    sizes = [line["resident_kB"] / 1024 for line in lines[1:]]
    return (f"### {last['hours']:.0f} hours in virtual time\n\n`aurasim-lab experiment endurance tower` has compared each of "
            f"{last['compared']:,} states with that of one node, beside {last['deaths']:,} deaths, {last['loads']:,} loads of "
            f"saved worlds and {last['orders']:,} orders: {last['failure'] or 'none differs'}. {last['computed']:,} states were "
            f"computed; memory {min(sizes):.0f} to {max(sizes):.0f} MiB after the first hour.\n\n")


def cost_rows(rows):
    result = []
    for scene in sorted({row["scene"] for row in rows}):
        cells = [scene]
        medians = {}
        for rule in ("stop", "recover"):
            of_rule = [row for row in rows if row["scene"] == scene and row["rule"] == rule]
            medians[rule] = {key: statistics.median(row[key] for row in of_rule) for key in ("p50", "p99")}
            cells += [f"{medians[rule]['p50']:.2f}", f"{medians[rule]['p99']:.2f}"]
            if rule == "recover":
                seconds = of_rule[0]["seconds"]
                sent = statistics.median(row["aura_bytes"] for row in of_rule) / seconds / 1e3
                kept = statistics.median(row["bytes"] for row in of_rule) / seconds / 1e3
        cells += [f"{100 * (medians['recover']['p99'] / medians['stop']['p99'] - 1):+.0f}%", f"{sent:.1f}", f"{kept:.1f}"]
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
    rolling = rolling_text(read_lines(options.directory / "rolling.jsonl"))
    soak = soak_text(read_lines(options.directory / "soak.jsonl"))
    endurance = endurance_text(read_lines(options.directory / "endurance.jsonl"))
    text = TEXT.format(rolling=rolling, soak=soak, endurance=endurance, measured=measured_line(options.directory),
                       machine=machine_line(), sums=sums, steps=max(r["steps"] or 0 for r in runs),
                       misses=miss_lines(runs), rounds=len(costs) // 4,
                       costs=table(["scene", "without: frame p50, ms", "p99", "with: p50", "p99", "p99 with to without",
                                    "sent to neighbours, kB/s", "to keepers, kB/s"], cost_rows(costs)))
    put_section(options.out / "results.md", "recovery", text)


if __name__ == "__main__":
    main()
