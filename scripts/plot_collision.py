#!/usr/bin/python3
"""The figures of the thesis's section 5.2 from what `aurasim-lab experiment` wrote.

    scripts/plot_collision.py DIR [--loss DIR] [--out DIR/figures]

Reads DIR/collisions.csv and DIR/aura_radius.csv (and the loss experiment's collisions.csv), writes PNG and SVG, each
named after the thesis's figure and what it shows.
"""
import argparse
import csv
import math
import pathlib
from collections import Counter, defaultdict

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend comes first)

from report_parts import save  # noqa: E402

STEP_MS = 1000 / 60
# Thesis figure numbers: ratio of late and missed, mean penetration time, by series.
RATIO_FIGURE = {"speed_16m_s": "5.22", "speed_32m_s": "5.23", "speed_48m_s": "5.24",
                "latency_2ms": "5.29", "latency_8ms": "5.30", "latency_16ms": "5.31",
                "frame_8.33ms": "5.36", "frame_15ms": "5.37", "frame_33.33ms": "5.38"}
TIME_FIGURE = {"speed_16m_s": "5.25", "speed_32m_s": "5.26", "speed_48m_s": "5.27",
               "latency_2ms": "5.32", "latency_8ms": "5.33", "latency_16ms": "5.34",
               "frame_8.33ms": "5.39", "frame_15ms": "5.40", "frame_33.33ms": "5.41"}
RADIUS_FIGURE = {"speed": "5.21", "latency": "5.28", "frame": "5.35"}
AXIS = {"speed": "speed of each body (m/s)", "latency": "one-way latency (ms)", "frame": "frame time (ms)",
        "loss": "lost datagrams (%)"}
TOLERANCE_AXIS = {"speed": "speed tolerance (m/s)", "latency": "latency tolerance (ms)",
                  "frame": "frame-time tolerance (ms)"}
VARIANTS = [("none", "free_running", "tab:gray", "naive, free running"),
            ("tight_at_thesis_size", "free_running", "tab:orange", "tight at the thesis's size, free running"),
            ("swept", "free_running", "tab:blue", "swept, free running"),
            ("swept", "bounded", "tab:green", "swept, bounded")]


class Point:
    """All repeats at one value under one variant."""

    def __init__(self):
        self.trials = self.late = self.missed = 0
        self.times = []

    def add(self, row):
        if row["central_step"] == "":
            return
        self.trials += 1
        self.late += row["late"] == "1"
        self.missed += row["missed"] == "1"
        if row["penetration_time_ms"]:
            self.times.append(float(row["penetration_time_ms"]))

    def late_to_correct(self):
        correct = self.trials - self.late - self.missed
        return self.late / correct if correct else float("nan")

    def missed_to_all(self):
        return self.missed / self.trials if self.trials else float("nan")

    def mean_and_spread(self):
        if not self.times:
            return float("nan"), 0
        mean = sum(self.times) / len(self.times)
        return mean, 2 * math.sqrt(sum((t - mean) ** 2 for t in self.times) / len(self.times))


def read_points(file):
    """Head-on pairs: {series: {(aura, sync): {value: Point}}}, and how often pairs changed host."""
    points = defaultdict(lambda: defaultdict(lambda: defaultdict(Point)))
    moves = defaultdict(Counter)
    with open(file, newline="") as rows:
        for row in csv.DictReader(rows):
            if row["pairs"] != "head_on":
                continue
            points[row["series"]][row["aura"], row["sync"]][float(row["value"])].add(row)
            if row["series"] == "frame_33.33ms" and row["aura"] not in ("central", "none"):
                moves[row["aura"]][int(row["hand_offs"])] += 1
    return points, moves


def tolerance_of(series):
    text = series.split("_")[1] if "_" in series else ""
    digits = "".join(c for c in text if c.isdigit() or c == ".")
    return float(digits) if digits else None


def mark_tolerance(axes, series):
    tolerance = tolerance_of(series)
    if tolerance is not None:
        axes.axvline(tolerance, color="green", linestyle="--", linewidth=1, label="tolerance")


def plot_ratios(folder, figure_number, series, variants):
    figure, (late, missed) = plt.subplots(2, 1, sharex=True, figsize=(7, 6))
    for aura, sync, colour, label in VARIANTS:
        points = sorted(variants.get((aura, sync), {}).items())
        if not points:
            continue
        values = [v for v, _ in points]
        late.plot(values, [p.late_to_correct() for _, p in points], ".-", color=colour, label=label, linewidth=1)
        missed.plot(values, [p.missed_to_all() for _, p in points], ".-", color=colour, label=label, linewidth=1)
    for axes in (late, missed):
        mark_tolerance(axes, series)
        axes.grid(alpha=0.3)
    late.set_yscale("symlog", linthresh=0.1)
    late.set_ylim(bottom=0)
    missed.set_ylim(-0.02, 1.02)
    late.set_ylabel("late / correct collisions")
    missed.set_ylabel("missed / all collisions")
    missed.set_xlabel(AXIS[series.split("_")[0]])
    late.legend(fontsize=7)
    late.set_title(f"as thesis figure {figure_number}: {series}", fontsize=10)
    save(figure, folder, f"fig_{figure_number}_{series}_late_and_missed")


def plot_times(folder, figure_number, series, variants):
    figure, panels = plt.subplots(2, 2, sharex=True, sharey=True, figsize=(9, 6.5))
    for axes, (aura, sync, colour, label) in zip(panels.flat, VARIANTS):
        points = sorted(variants.get((aura, sync), {}).items())
        values = [v for v, _ in points]
        spread = [p.mean_and_spread() for _, p in points]
        axes.errorbar(values, [m for m, _ in spread], yerr=[s for _, s in spread], fmt=".", color=colour,
                      linewidth=0.6, markersize=3)
        axes.axhline(STEP_MS, color="blue", linestyle="--", linewidth=1)
        mark_tolerance(axes, series)
        axes.set_ylim(-20, 6 * STEP_MS)
        axes.set_title(label, fontsize=8)
        axes.grid(alpha=0.3)
    figure.supxlabel(AXIS[series.split("_")[0]], fontsize=9)
    figure.supylabel("penetration time (ms), mean +- 2 standard deviations", fontsize=9)
    figure.suptitle(f"as thesis figure {figure_number}: {series}; one step is dashed blue", fontsize=10)
    save(figure, folder, f"fig_{figure_number}_{series}_penetration_time")


def plot_control(folder, file):
    speeds, times = [], []
    with open(file, newline="") as rows:
        for row in csv.DictReader(rows):
            wanted = row["pairs"] == "head_on" and row["aura"] == "central" and row["series"].startswith("speed")
            if wanted and row["penetration_time_ms"] and float(row["value"]) <= 64:
                speeds.append(float(row["value"]))
                times.append(float(row["penetration_time_ms"]))
    figure, axes = plt.subplots(figsize=(7, 4))
    axes.plot(speeds, times, ".", markersize=1.5)
    axes.axhline(STEP_MS, color="blue", linestyle="--", linewidth=1, label="one step")
    axes.set_xlabel(AXIS["speed"])
    axes.set_ylabel("penetration time (ms)")
    axes.set_title(f"as thesis figure 5.18: control, one node, {len(times)} collisions", fontsize=10)
    axes.legend(fontsize=8)
    axes.grid(alpha=0.3)
    save(figure, folder, "fig_5.18_control_penetration_time")


def plot_radius(folder, file):
    rows = defaultdict(list)
    with open(file, newline="") as lines:
        for row in csv.DictReader(lines):
            rows[row["factor"]].append(row)
    for factor, number in RADIUS_FIGURE.items():
        figure, axes = plt.subplots(figsize=(7, 4))
        x = [float(r["tolerance"]) for r in rows[factor]]
        for column, label in (("thesis_m", "thesis, eq. 3.4"), ("tight_m", "tight"),
                              ("swept_m", "swept, two bodies head on at top speed")):
            axes.plot(x, [float(r[column]) for r in rows[factor]], label=label)
        for series in RATIO_FIGURE:
            if series.startswith(factor):
                axes.axvline(tolerance_of(series), color="green", linestyle="--", linewidth=0.8)
        axes.set_xlabel(TOLERANCE_AXIS[factor])
        axes.set_ylabel("aura beyond the bounding sphere (m)")
        axes.set_title(f"as thesis figure {number}", fontsize=10)
        axes.set_ylim(bottom=0)
        axes.legend(fontsize=8)
        axes.grid(alpha=0.3)
        save(figure, folder, f"fig_{number}_aura_size_{factor}")


def plot_moves(folder, moves):
    figure, axes = plt.subplots(figsize=(7, 4))
    most = max((max(counts) for counts in moves.values() if counts), default=1)
    width = 0.8 / max(1, len(moves))
    for i, (aura, counts) in enumerate(sorted(moves.items())):
        axes.bar([n + i * width for n in range(most + 1)], [counts[n] for n in range(most + 1)], width, label=aura)
    axes.set_xticks([n + 0.4 - width / 2 for n in range(most + 1)], [str(n) for n in range(most + 1)])
    axes.set_xlabel("hand-offs of a pair before its first contact (two or more: thrashed)")
    axes.set_ylabel("trials")
    axes.set_title("as thesis figure 5.42: frame_33.33ms", fontsize=10)
    axes.legend(fontsize=8)
    save(figure, folder, "fig_5.42_hand_offs")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory", type=pathlib.Path, help="of `aurasim-lab experiment collision`")
    parser.add_argument("--loss", type=pathlib.Path, help="of `aurasim-lab experiment loss`")
    parser.add_argument("--out", type=pathlib.Path, help="folder for the figures (DIR/figures)")
    arguments = parser.parse_args()
    folder = arguments.out or arguments.directory / "figures"
    folder.mkdir(parents=True, exist_ok=True)
    plt.rcParams["svg.hashsalt"] = "aurasim"
    points, moves = read_points(arguments.directory / "collisions.csv")
    for series, number in RATIO_FIGURE.items():
        if series in points:
            plot_ratios(folder, number, series, points[series])
            plot_times(folder, TIME_FIGURE[series], series, points[series])
    plot_control(folder, arguments.directory / "collisions.csv")
    plot_radius(folder, arguments.directory / "aura_radius.csv")
    if moves:
        plot_moves(folder, moves)
    if arguments.loss:
        loss, _ = read_points(arguments.loss / "collisions.csv")
        plot_ratios(folder, "5.43", "loss", loss["loss"])
        plot_times(folder, "5.44", "loss", loss["loss"])


if __name__ == "__main__":
    main()
