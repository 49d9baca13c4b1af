#!/usr/bin/python3
"""The figures of the thesis's section 5.1 from what `aurasim-lab experiment scalability` wrote.

    scripts/plot_scalability.py DIR [--out DIR/figures]

Reads DIR/summary.json and DIR/runs/*.csv; writes PNG and SVG, named after the thesis's figures.
"""
import argparse
import csv
import json
import pathlib
from collections import defaultdict

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend comes first)

from report_parts import save  # noqa: E402

WINDOW_S = 5


def windows_of(directory, run, region="-1"):
    with open(directory / run["windows"], newline="") as rows:
        return [{k: float(v) for k, v in r.items()} for r in csv.DictReader(rows) if r["region"] == region]


def curves(directory, runs, value):
    """{label: (times, medians over repeats)}; `value(window)` picks the number."""
    points = defaultdict(lambda: defaultdict(list))
    for run in runs:
        for w in windows_of(directory, run):
            points[run["label"]][w["begin_s"] + WINDOW_S].append(value(w))
    return {label: (sorted(at), [sorted(at[t])[len(at[t]) // 2] for t in sorted(at)]) for label, at in points.items()}


def plot(directory, folder, name, runs, value, ylabel, log=False, against=None):
    if not runs:
        return
    figure, axes = plt.subplots(figsize=(7, 4))
    for label, (xs, ys) in curves(directory, runs, value).items():
        if against:
            xs = curves(directory, [r for r in runs if r["label"] == label], against)[label][1]
        axes.plot(xs, ys, ".-", linewidth=1, label=label)
    axes.set_xlabel("bodies of all nodes" if against else "simulated time (s)")
    axes.set_ylabel(ylabel)
    if log:
        axes.set_yscale("log")
    axes.grid(alpha=0.3)
    axes.legend(fontsize=7)
    save(figure, folder, name)


def labelled(runs, series, label, **wanted):
    chosen = [dict(r, label=label(r)) for r in runs
              if r["series"] == series and all(r[k] == v for k, v in wanted.items())]
    return sorted(chosen, key=lambda r: r["nodes"])


def plot_speed_up(folder, summary):
    figure, axes = plt.subplots(figsize=(6, 4.5))
    by = defaultdict(list)
    for row in summary["speed_up"]:
        by[row["series"], row["aura"]].append((row["nodes"], row["frame_p95"]["median"]))
    for (series, aura), points in by.items():
        points.sort()
        axes.plot(*zip(*points), ".-", linewidth=1, label=f"{series}, {aura}")
    axes.plot([2, 4, 8], [1.74, 3.40, 4.22], "ko--", linewidth=1, label="thesis (fitted coefficients)")
    most = max((n for p in by.values() for n, _ in p), default=8)
    axes.plot([1, most], [1, most], color="gray", linewidth=0.8, label="as many times as nodes")
    axes.set_yscale("log")
    axes.set_xlabel("nodes")
    axes.set_ylabel("one node's frame / slowest node's frame")
    axes.grid(alpha=0.3, which="both")
    axes.legend(fontsize=7)
    save(figure, folder, "fig_5.17_speed_up")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("directory", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path)
    arguments = parser.parse_args()
    directory = arguments.directory
    folder = arguments.out or directory / "figures"
    folder.mkdir(parents=True, exist_ok=True)
    summary = json.loads((directory / "summary.json").read_text())
    runs = summary["runs"]
    columns = labelled(runs, "columns", lambda r: f"{r['nodes']} columns", aura="swept")
    corners = labelled(runs, "corners", lambda r: f"{r['nodes']}, {r['regions'].split('_')[0]}")
    frame = "largest frame of any node (ms CPU)"
    plot(directory, folder, "fig_5.2_frame_columns", columns, lambda w: w["frame_max_ms"], frame, log=True)
    plot(directory, folder, "fig_5.5_frame_corners", corners, lambda w: w["frame_max_ms"], frame, log=True)
    plot(directory, folder, "fig_5.6_hand_offs_columns", columns[1:], lambda w: w["departures"], "bodies handed over per 5 s")
    plot(directory, folder, "fig_5.7_hand_offs_corners", corners, lambda w: w["departures"], "bodies handed over per 5 s")
    plot(directory, folder, "fig_5.8_updates_columns", columns[1:], lambda w: w["aura_updates"], "aura messages per 5 s")
    plot(directory, folder, "fig_5.9_updates_corners", corners, lambda w: w["aura_updates"], "aura messages per 5 s")
    for name, log in (("fig_5.10_cost_over_bodies", False), ("fig_5.11_cost_over_bodies_log", True)):
        figure_runs = columns
        plot(directory, folder, name, figure_runs, lambda w: w["frame_max_ms"], frame, log=log,
             against=lambda w: w["bodies"])
    plot(directory, folder, "fig_5.14_cost_per_body", columns, lambda w: 1e3 * w["frame_mean_ms"] / max(1, w["bodies"]),
         "slowest node's frame / all bodies (us)", against=lambda w: w["bodies"])
    auras = [r for n in (2, 8) for r in labelled(runs, "columns", lambda r: f"{r['nodes']} columns, {r['aura']}", nodes=n)]
    plot(directory, folder, "percolation_largest_cluster", auras, lambda w: max(1, w["largest_cluster"]),
         "bodies of the largest cluster", log=True)
    plot(directory, folder, "percolation_frame", auras, lambda w: w["frame_max_ms"], frame, log=True)
    plot_speed_up(folder, summary)


if __name__ == "__main__":
    main()
