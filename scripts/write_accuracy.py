#!/usr/bin/python3
"""Writes docs/accuracy.md from the results of the stability and pareto experiments.

    scripts/write_accuracy.py DIR [--out docs]

DIR holds stability-double and pareto-double, as scripts/accuracy.sh leaves them.
"""
import argparse
import json
import math
import pathlib
import shutil

from plot_accuracy import rows_of
from report_parts import machine_line, measured_line, table

STEPS = ("60", "120", "240", "1000")
GRAVITY = 9.81  # m/s^2
PRESETS = ("fast", "balanced", "exact")
FIGURES = ["pareto_double", "convergence_double"]

INTRODUCTION = """# How exact, and what each digit costs

{measured}

Written by `scripts/accuracy.sh`; do not edit. {machine}. Where cells are empty it was a short run (`AURASIM_QUICK=1`).

## What is measured

Scenes with a known answer, run in virtual time with the node (`node::Node`), the protocol and the physics of a real run:
once on one node, once on two whose border goes through the scene (`deterministic`, lookahead 1, `swept` auras). Bodies
never sleep, unless a row says so. *Bullet's settings*: sequential impulse, 10 iterations, 1 substep, friction in 1
direction, contact error reduction 0.2. The presets `fast` and `balanced`, which is the default, are the soft step
(decision 0020), `exact` is sequential impulse again. CPU time is that of the thread (node, protocol and physics), of one run; other
programs ran beside it.

## What is not Bullet's own

The soft step is not Bullet's at all but for where bodies touch. Of the other solvers:

| | here | Bullet 3.24 as it comes |
|---|---|---|
| torque-free rotation | a chain of turns about the body's axes, symplectic, momentum kept in the world frame (`physics/free_rotation.h`); bodies of equal inertia or at rest pay nothing | Dzhanibekov, 1/60 s: momentum error 0.167 (implicit torque), 0.26 (explicit) |
| bounces | in the substep in which bodies would touch, with the speed of the bounce *or* that of the push out of the overlap, whichever is higher (`physics/solvers.h`) | their sum: bouncing ball, restitution 1, 1/240 s: energy +165% in 20 s |
| corners on a plane | all corners of a box or hull are found in one substep, and points that have slid away are dropped first (`physics/dispatcher.cpp`) | one per substep, lost again while the body slides: sliding box 0.127 m, incline 0.061 m off (1/60 s); a flat box with restitution 1 begins to spin and gains up to 19% energy in 5 s (1/240 s) |
| contacts that stick | remember how far they have slid all the same, and friction pulls them back (`physics/friction_anchors.h`); rolling adds nothing to that way | friction looks at speeds only: what the solver leaves over adds up, and 1:100 on 5 walks away within a minute unless bodies sleep. Bullet's friction anchors stop that but hold balls back (rolling plate 5e-3 m^2/s^2) |
| friction | rows in one direction as Bullet's, or in two (`physics.friction_directions: 2`, the preset `exact`) | one, which where nothing slides yet is any direction: rolling plate 1e-6 m^2/s^2, card house falls |
| fast bodies | `physics.continuous`: stopped at what is in the way, no contacts ahead of time (no hand-off could carry them); with the soft step contacts ahead of time | both |

"""


def cell(text):
    return text.replace("|", "\\|")


def number(text):
    return f"{float(text):.3g}"


def bound_of(target):
    return f"at least {target['at_least']:g}" if "at_least" in target else f"at most {target['at_most']:g}"


def targets_table(summaries):
    rows = []
    for summary in summaries:
        for t in summary["targets"]:
            rows.append([cell(t["name"]), summary["precision"], f"{t['found']:.3g}", bound_of(t),
                         "met" if t["met"] else "**not met**"])
    return table(["requirement", "precision", "found", "allowed", ""], rows)


def metrics_of(rows):
    """(case, measured) in order, with its rows."""
    metrics = {}
    for r in rows:
        metrics.setdefault((r["case"], r["measured"]), []).append(r)
    return metrics


def errors_table(rows):
    header = ["case", "measured"] + [f"1/{hz} s" for hz in STEPS] + list(PRESETS) + ["hand-offs", "same bits"]
    out = []
    for (case, measured), some in metrics_of([r for r in rows if not is_standing(r)]).items():
        by_step = {r["step_hz"]: r for r in some if not r["preset"]}
        by_preset = {r["preset"]: r for r in some}
        cells = [number(by_step[hz]["error_one_node"]) if hz in by_step else "" for hz in STEPS]
        cells += [number(by_preset[p]["error_one_node"]) if p in by_preset else "" for p in PRESETS]
        most = max(int(r["hand_offs"]) for r in some)
        same = all(r["same_bits"] == "1" and r["error_one_node"] == r["error_two_nodes"] for r in some)
        out.append([case, cell(f"{measured}, {some[0]['unit']}")] + cells + [most, "yes" if same else "**no**"])
    return table(header, out)


def is_standing(row):
    return row["preset"] == "balanced" and float(row["simulated_s"]) >= 30 and row["case"] != "bouncing_ball_1"


def standing_table(rows):
    return table(["pile", "simulated, s", "measured", "one node", "two nodes", "CPU us per step"],
                 [[r["case"], r["simulated_s"], cell(f"{r['measured']}, {r['unit']}"), number(r["error_one_node"]),
                   number(r["error_two_nodes"]), number(r["cpu_us_per_step"])] for r in rows if is_standing(r)])


def cost_table(rows):
    out = []
    metrics = metrics_of([r for r in rows if r["step_hz"] == "60" and not is_standing(r)])
    seen = set()
    for case, measured in metrics:
        if case in seen:
            continue
        seen.add(case)
        cost = {r["preset"]: number(r["cpu_us_per_step"]) for r in metrics[case, measured]}
        out.append([case] + [cost.get(p, "") for p in ("",) + PRESETS])
    return table(["case", "Bullet's", *PRESETS], out)


def references_table(rows):
    first = {r["case"]: r for r in reversed(rows)}
    return table(["case", "compared with", "seed", "simulated, s"],
                 [[name, cell(r["reference"]), r["seed"] if r["seed"] != "0" else "nothing is random", r["simulated_s"]]
                  for name, r in reversed(first.items())])


SOFT_PRESETS = ("fast", "balanced")

# Distance behind the closed form, m, that a semi-implicit Euler step of dt has by itself: speed goes before place.
OWN_ERRORS = {
    "free_fall": ("g t dt / 2", lambda dt: GRAVITY * 2 * dt / 2),
    "sliding_box": ("v0 dt / 2", lambda dt: 5 * dt / 2),
    "incline": ("a t dt / 2", lambda dt: GRAVITY * (math.sin(math.pi / 6) - 0.25 * math.cos(math.pi / 6)) * 2 * dt / 2),
}


def own_errors_table(rows):
    out = []
    for case, (formula, error) in OWN_ERRORS.items():
        for r in rows:
            if r["case"] == case and r["preset"] not in SOFT_PRESETS:
                dt = 1 / (int(r["step_hz"]) * int(r["substeps"]))
                out.append([case, r["preset"] or f"1/{r['step_hz']} s", formula, number(error(dt)),
                            number(r["error_one_node"])])
    return table(["case", "step or preset", "the scheme's own error", "m", "found, m"], out)


def poor_part(double):
    text = """## Where errors stay, and why

*Free fall and slides* of Bullet's solvers show nothing but the integrator's own first order in dt, the substep. Auras
predict the same path (`core/aura.cpp`), so it stays. The soft step flies on the parabola.

"""
    text += own_errors_table(double)
    text += """- *Newton's cradle, double pendulum, chain*: each joint starts at zero in every substep, for which 10 iterations are few;
  the chain's gap falls with about the square of the substep. Decision 0014 has what was tried.
- *Piles of the soft step* are springs: they sink by a share of their height that follows from the steps' rate, not from
  the substeps. Decision 0020 has what stiffer ones do.
- *Rolling plate, soft step*: where a ball touches is found once a step, and stays there on the plate for its duration.
- *1 cm cubes* fall where gravity moves them by more than a few tenths of a millimetre in a substep (2.7 mm at 1/60 s): to
  a cube of 1 m that would be a step of 1/6 s. They stand at 1/1000 s and with `exact`, not with springs.
- *1:1000 on 5* falls at Bullet's settings down to 1/240 s, and with the soft step; it stands with `exact`.
- *Deep overlap*: the last 4 cm are undone by a speed that stays, a fifth of the overlap per substep, so the bodies part
  faster the smaller the substep. Decision 0014 says what a limit would cost.
- *Bouncing ball, restitution 0.5*: a bounce is in one substep or the next, and so are all that follow.

"""
    return text


def error_columns(row):
    keys = list(row)
    return keys[keys.index("preset") + 1:keys.index("error")]


def is_about_nodes(row):
    return row["nodes"] != "1" or (row["sync"], row["lookahead"], row["aura"]) != ("deterministic", "1", "swept")


def front_table(rows):
    columns = error_columns(rows[0])
    some = sorted((r for r in rows if not is_about_nodes(r) and (r["on_front"] == "1" or r["preset"])),
                  key=lambda r: float(r["cpu_us_per_step"]))
    return table(["solver", "iterations", "substeps", "friction", "CPU us", "error"] + columns + ["on the front", "preset"],
                 [[r["solver"], r["iterations"], r["substeps"], r["friction_directions"], number(r["cpu_us_per_step"]),
                   number(r["error"])] + [number(r[c]) for c in columns]
                  + ["yes" if r["on_front"] == "1" else "no", r["preset"]] for r in some])


def nodes_table(rows):
    return table(["nodes", "sync", "K", "aura", "CPU us, busiest node", "error", "same bits as one node"],
                 [[r["nodes"], r["sync"], r["lookahead"], r["aura"], number(r["cpu_us_per_step"]), number(r["error"]),
                   "yes" if r["same_bits"] == "1" else "no"] for r in rows if is_about_nodes(r) or r["preset"] == "balanced"])


def pareto_part(directory):
    double = rows_of(directory / "pareto-double" / "pareto.csv")
    text = """## Error against CPU time

Every solver, iterations, substeps and directions of friction, at 60 steps per second: stack of 10, 1:100 on 5, Newton's
cradle, chain of 50, card house. Error: geometric mean of their errors (nothing below 1e-6 counts as better); CPU time:
sum over the cases. The front, and the presets:

"""
    text += front_table(double)
    text += """Dantzig is direct, and knows no iterations; its time grows with the cube of the contacts of a pile. NNCG is the
better one where joints act alone (Newton's cradle), but throws a card house apart, as Bullet's own does: no solver for
piles with friction. The soft step knows neither iterations nor directions of friction.

### The presets (`physics.preset`)

`balanced` is the default: the soft step with 8 substeps. It stands where what is usual stands (the four piles, for a
minute), is exact in flight, better than sequential impulse of 20 iterations x 4 substeps in joints
and slides, and takes a tenth of its time and less in large piles ([decision 0020](decisions/0020-the-soft-step.md) has
both side by side, also what has become worse). `fast`: 4 substeps, where joints give more. `exact`: sequential impulse
with as many iterations as a rolling plate needs to be exact in the last digits, for piles that may not sink and for
weights of 1:1000. Where the table says that a preset is not on the front, another point is cheaper and better on these
cases. `physics.solver`, `iterations`, `friction_directions` and `time.substeps` go before a preset.

### Nodes

The preset `balanced`. In `bounded` and `free_running` nothing promises equal bits.

"""
    return text + nodes_table(double)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path(__file__).parent.parent / "docs")
    arguments = parser.parse_args()
    directory = arguments.directory
    double = rows_of(directory / "stability-double" / "stability.csv")
    names = ("stability-double", "pareto-double")
    summaries = [json.loads((directory / name / "summary.json").read_text()) for name in names]

    text = INTRODUCTION.format(machine=machine_line(), measured=measured_line(directory))
    text += "## What has to hold, and what was found\n\n" + targets_table(summaries)
    text += "## Hard cases\n\nThe error on two nodes is that on one wherever it says *same bits*.\n\n"
    text += errors_table(double)
    text += poor_part(double)
    text += """## Standing for a minute, preset `balanced`

`_may_sleep`: bodies fall asleep as in any scene that does not forbid it.

""" + standing_table(double)
    text += "## CPU time per step, one node, microseconds, 60 steps per second\n\n" + cost_table(double)
    text += pareto_part(directory)
    text += "## References\n\n" + references_table(double)
    pictures = arguments.out / "accuracy"
    pictures.mkdir(parents=True, exist_ok=True)
    text += "## Figures\n\n"
    for name in FIGURES:
        shutil.copy(directory / "figures" / f"{name}.png", pictures / f"{name}.png")
        text += f"![{name}](accuracy/{name}.png)\n\n"
    (arguments.out / "accuracy.md").write_text(text.rstrip() + "\n")


if __name__ == "__main__":
    main()
