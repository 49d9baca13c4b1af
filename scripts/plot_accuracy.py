#!/usr/bin/python3
"""Figures of the stability and pareto experiments.

    scripts/plot_accuracy.py DIR [--out DIR/figures]

DIR holds stability-double and pareto-double, as scripts/accuracy.sh leaves them.
Writes PNG and SVG.
"""
import argparse
import csv
import pathlib
from collections import defaultdict

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (the backend comes first)

from report_parts import save  # noqa: E402

MARKERS = {("sequential_impulse", "1"): ("o", "tab:blue"), ("sequential_impulse", "2"): ("o", "tab:green"),
           ("soft_step", "1"): ("s", "tab:orange")}
CONVERGING = ["free_fall", "projectile", "spring", "spinning_disc", "sliding_box", "incline", "bouncing_ball_0.5",
              "wedge", "double_pendulum"]
LEAST = 1e-16  # what is 0 has to be somewhere on a logarithmic axis


def rows_of(file):
    with open(file, newline="") as rows:
        return list(csv.DictReader(rows))


def plot_front(folder, rows):
    figure, axes = plt.subplots(figsize=(8, 5.5))
    alone = [r for r in rows if r["nodes"] == "1" and r["sync"] == "deterministic" and r["lookahead"] == "1"
             and r["aura"] == "swept"]
    for (solver, directions), (marker, colour) in MARKERS.items():
        some = [r for r in alone if (r["solver"], r["friction_directions"]) == (solver, directions)]
        axes.scatter([float(r["cpu_us_per_step"]) for r in some], [float(r["error"]) for r in some], s=22,
                     marker=marker, color=colour, label=f"{solver}, friction in {directions} direction(s)")
    front = sorted((float(r["cpu_us_per_step"]), float(r["error"])) for r in alone if r["on_front"] == "1")
    axes.plot(*zip(*front), color="black", lw=0.8, label="front")
    for r in alone:
        if r["preset"]:
            axes.annotate(r["preset"], (float(r["cpu_us_per_step"]), float(r["error"])), xytext=(6, 6),
                          textcoords="offset points", weight="bold")
    axes.set(xscale="log", yscale="log", xlabel="CPU time per step, all cases (us)",
             ylabel="geometric mean of the errors", title="Error against CPU time, one node")
    axes.legend(fontsize=8)
    axes.grid(alpha=0.3, which="both")
    save(figure, folder, "pareto")


def plot_convergence(folder, rows):
    figure, axes = plt.subplots(figsize=(8, 5.5))
    lines = defaultdict(list)
    for r in rows:
        if r["case"] in CONVERGING and not r["preset"]:
            lines[r["case"], r["measured"]].append((1000 / float(r["step_hz"]), max(LEAST, float(r["error_one_node"]))))
    for (case, measured), points in lines.items():
        axes.plot(*zip(*sorted(points)), marker="o", ms=4, label=f"{case}: {measured}")
    axes.set(xscale="log", yscale="log", xlabel="step (ms)", ylabel="error (m, rad or 1)",
             title="Error against step, Bullet's settings")
    axes.legend(fontsize=6)
    axes.grid(alpha=0.3, which="both")
    save(figure, folder, "convergence")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path)
    arguments = parser.parse_args()
    folder = arguments.out or arguments.directory / "figures"
    folder.mkdir(parents=True, exist_ok=True)
    plot_front(folder, rows_of(arguments.directory / "pareto" / "pareto.csv"))
    plot_convergence(folder, rows_of(arguments.directory / "stability" / "stability.csv"))


if __name__ == "__main__":
    main()
