#!/usr/bin/python3
"""Writes docs/speed.md from the runs of our step and of other engines.

    scripts/write_speed.py DIR [--out docs]

DIR holds runs.csv, errors.csv, engines.txt and measured.txt, as scripts/peers.sh leaves them.
"""
import argparse
import csv
import pathlib
import statistics

from report_parts import machine_line, measured_line, table

# What is told of a scene beside its speed: column of errors.csv, what it is called, how it is written.
OVERLAP = ("overlap_m", "deepest overlap, mm", lambda x: f"{1e3 * x:.3g}")
IN_STATIC = ("in_static_m", "deepest in the ground, mm", lambda x: f"{1e3 * x:.3g}")
SUNK = ("sunk_m", "most sunk, mm", lambda x: f"{1e3 * x:.3g}")
DRIFT = ("drift_m", "farthest drift, m", lambda x: f"{x:.3g}")
FALLEN = ("fallen", "fallen", lambda x: f"{x:.0f}")
LOST = ("lost", "lost", lambda x: f"{x:.0f}")
ENERGY = ("energy", "energy gained", lambda x: f"{100 * x:+.3g}%")
GAP = ("joint_gap_m", "widest joint gap, mm", lambda x: f"{1e3 * x:.3g}")
TURN = ("hinge_turn_rad", "hinge off axis or limits, rad", lambda x: f"{x:.2g}")

SCENES = {
    "rain": ("The thesis rain, 60 s of it: 9,588 balls, boxes and capsules that fall over 4 columns of 80 m; friction "
             "of a pair 0.25. Bodies may sleep.", (OVERLAP, IN_STATIC, LOST)),
    "pyramid": ("5,050 cubes of 1 m in 100 rows, side by side, friction 0.6, 5 s. *Fallen*: lower than at first by more "
                "than 0.5 m.", (SUNK, OVERLAP, DRIFT, FALLEN)),
    "hulls": ("2,000 convex hulls of 24 points, 0.4 to 0.8 m long, fall into a heap on the ground; friction 0.5, 10 s.",
              (OVERLAP, IN_STATIC, LOST)),
    "ragdolls": ("400 ragdolls of 11 bodies and 10 joints (5 hinges with limits, 5 balls) fall down stairs, 10 s.",
                 (GAP, TURN, OVERLAP, IN_STATIC, LOST)),
    "card_houses": ("40 houses of 15 cards in three storeys, 10 s. *Fallen*: cards lower than at first by more than "
                    "0.2 m.", (FALLEN, SUNK, DRIFT, OVERLAP)),
    "gas": ("64,000 balls with a radius of 0.25 m in a closed box of 40 m, elastic, no friction, no gravity, 5 s.",
            (ENERGY, OVERLAP, LOST)),
    "sleepers": ("10,000 cubes of 1 m in piles of four, 1.5 m apart, friction 0.6, 12 s. They may sleep, and do at the end.",
                 (SUNK, DRIFT, OVERLAP)),
}

INTRODUCTION = """# How fast a step is, beside other engines

{measured}

Written by `scripts/peers.sh`; do not edit. {machine}. {engines}

The same bodies for all: our side writes each scene as a text (`src/lab/speed/scene_text.h`), from which ours and
the driver of each engine (`tests/bench/peers`) make their worlds. Steps of 1/60 s. *CPU ms*: CPU time of the whole
process in a step, the median of the runs; *at the end*: in the last 5 s, or the last quarter of a shorter scene, when
piles are what they will be. *Runs* were taken by turns; what takes minutes is run once. Ours is one `RegionWorld`, as a
node has it, without node and protocol. Errors are told by one program (`aurasim-lab experiment speed-errors`) from four
states of the latest run, by the shapes as the scene has them: *overlap*, *gap* and *in the ground* are the worst of the
four, the others are of the last.

"""

SETTINGS = """## How each is set up, and why that is fair

| | here |
|---|---|
| aurasim | `fast`, `balanced` (what a launch file has that says nothing): the soft step with 4 and 8 substeps, for 1 and 2 threads; `12_substeps`; `sequential_impulse`: Bullet's own solver, 10 iterations x 4 substeps; `one_substep`: 10 x 1, as Bullet and the thesis; `exact`: 50 x 8 ([accuracy.md](accuracy.md)). The soft step chooses SSE2, AVX2 or AVX-512 at run time; the rest is compiled for any x86-64 (SSE2) |
| Bullet | Debian's, both precisions, as it comes: 10 iterations, one step of 1/60 s, friction in 1 direction. One thread, SSE2. Its hulls have its margin of 40 mm *outside*: they never come close enough to overlap. It takes capsules and hulls for their boxes where it computes inertia |
| Jolt | as it comes: 1 collision step, 10 velocity and 2 position iterations, single precision. Boxes thinner than its rounding of 50 mm are rounded by half of their thinnest side |
| box3d | as it comes: 4 substeps, single precision. The ground is the top of a box of 4 km, since it has no planes |

Every engine has its own defaults, which are what its authors recommend, but where the scene says otherwise:

- Friction and restitution of a pair are the product of the two bodies', as Bullet and ours have it; Jolt and box3d are
  told to multiply, too. Damping and rolling friction are 0.
- Any speed bounces where restitution is 1: the speeds below which Bullet, Jolt and box3d do not bounce are set to 0.
- Bodies sleep by each engine's own rules in the rain and among the sleepers, and nowhere else.
- Hulls are symmetric, so that centre of mass and principal axes are the same however an engine finds them. The hips of
  the ragdolls are balls, where the shipped scene has springs. Joined bodies do not collide.
- Ours is built by our compiler with `-O3` (`Release`). Bullet, also what we use of it, is Debian's build. Jolt and box3d
  are linked as they are installed: whoever installed them has chosen compiler, optimisation and instructions.

Bodies are put in before the clock is started, and states written after it is stopped.

"""


def rows_of(file):
    with open(file, newline="") as lines:
        return list(csv.DictReader(lines))


def key_of(row):
    return row["scene"], row["engine"], row["precision"], int(row["threads"])


class Runs:
    """All runs of one scene by one engine."""

    def __init__(self, rows, errors):
        self.rows = rows
        self.errors = errors
        _, self.engine, self.precision, self.threads = key_of(rows[0])

    def median(self, what, per):
        return statistics.median(float(r[what]) / float(r[per]) for r in self.rows)

    def spread(self):
        """Of the CPU time, from the fastest run to the slowest, as a share of the median."""
        times = [float(r["cpu_ms"]) for r in self.rows]
        return (max(times) - min(times)) / statistics.median(times)

    def body_steps_per_s(self):
        return 1e3 * self.median("body_steps", "cpu_ms")


def runs_by_scene(directory):
    errors = {key_of(row): row for row in rows_of(directory / "errors.csv")}
    grouped = {}
    for row in rows_of(directory / "runs.csv"):
        grouped.setdefault(key_of(row), []).append(row)
    scenes = {}
    for key, rows in grouped.items():
        scenes.setdefault(key[0], []).append(Runs(rows, errors[key]))
    return scenes


def told(runs, columns):
    return [write(float(runs.errors[name])) for name, _, write in columns]


def one_thread_table(all_runs, columns):
    header = ["engine", "precision", "CPU ms", "at the end", "body-steps per CPU s"] + [c[1] for c in columns]
    rows = []
    for runs in sorted(all_runs, key=lambda r: r.median("cpu_ms", "steps")):
        if runs.threads != 1:
            continue
        rows.append([runs.engine, runs.precision, f"{runs.median('cpu_ms', 'steps'):.3g}",
                     f"{runs.median('late_cpu_ms', 'late_steps'):.3g}", f"{runs.body_steps_per_s():,.0f}"]
                    + told(runs, columns) + [len(runs.rows), f"{100 * runs.spread():.0f}%"])
    return table(header + ["runs", "spread"], rows)


def threads_table(all_runs, columns):
    """Who has run with several threads, by the wall clock, beside one thread."""
    alone = {(r.engine, r.precision): r for r in all_runs if r.threads == 1}
    rows = []
    for runs in all_runs:
        if runs.threads == 1 or (runs.engine, runs.precision) not in alone:
            continue
        one = alone[runs.engine, runs.precision].median("wall_ms", "steps")
        several = runs.median("wall_ms", "steps")
        rows.append([runs.engine, runs.precision, runs.threads, f"{one:.3g}", f"{several:.3g}", f"{one / several:.2f}",
                     f"{runs.median('cpu_ms', 'steps'):.3g}"] + told(runs, columns))
    if not rows:
        return ""
    header = ["engine", "precision", "threads", "wall ms, one thread", "wall ms", "faster by", "CPU ms"]
    return "With several threads:\n\n" + table(header + [c[1] for c in columns], rows)


def overview_table(scenes):
    """CPU ms a step of everybody, one thread."""
    names = [name for name in SCENES if name in scenes]
    engines = dict.fromkeys((r.engine, r.precision) for name in names for r in scenes[name] if r.threads == 1)
    rows = []
    for engine, precision in engines:
        row = [engine, precision]
        for name in names:
            found = [r for r in scenes[name] if (r.engine, r.precision, r.threads) == (engine, precision, 1)]
            row.append(f"{found[0].median('cpu_ms', 'steps'):.3g}" if found else "")
        rows.append(row)
    return table(["engine", "precision"] + names, rows)


def engines_line(text):
    """What scripts/peers.sh has noted of the engines, in a sentence."""
    names = {"jolt": "Jolt", "box3d": "box3d", "bullet": "Bullet"}
    missing = {"left-out": "*left out, it is not installed*",
               "not-linked": "*left out, it is installed, but cannot be linked*"}
    parts = []
    for line in text.splitlines():
        engine, *rest = line.split()
        if engine in names:
            found = missing.get(rest[0], " ".join(rest))
            parts.append(f"{names[engine]}: {found}")
    return "; ".join(parts) + "."


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path(__file__).parent.parent / "docs")
    arguments = parser.parse_args()
    noted = (arguments.directory / "engines.txt").read_text()
    scenes = runs_by_scene(arguments.directory)

    small = "**Small scenes (`--quick`), not those that the headings speak of.** " if "small scenes" in noted else ""
    text = INTRODUCTION.format(measured=measured_line(arguments.directory), machine=machine_line(),
                               engines=small + engines_line(noted))
    text += "## CPU ms a step, one thread\n\n" + overview_table(scenes)
    for name, (what, columns) in SCENES.items():
        if name not in scenes:
            continue
        text += f"## {name}\n\n{what}\n\n" + one_thread_table(scenes[name], columns)
        text += threads_table(scenes[name], columns)
    text += SETTINGS
    (arguments.out / "speed.md").write_text(text.rstrip() + "\n")


if __name__ == "__main__":
    main()
