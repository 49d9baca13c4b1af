#!/usr/bin/env python3
"""What it costs to steer 1,000 bodies: balls that roll about over four regions, left alone and with a torque on each of
them, 60 times a second, by one client; by turns. Writes DIR/runs.jsonl and docs/results.md#control_cost."""
import argparse
import json
import pathlib
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np

from page_sections import put_section
from report_parts import machine_line, measured_line, table

TEXT = """## What steering costs

{measured}

Written by `scripts/control_cost.sh`; do not edit. {machine}.

{bodies} balls roll about in a pen over four regions of one host, `deterministic`, for {seconds} s paced by the clock. Each kind of
run was made {repeats} times, by turns. The table has medians of the runs; frames are those of the nodes while the client was there.

- *left alone*: no client.
- *looked at*: a client only observes ([`World.connect`](client.md)).
- *told*: the client sets a torque of {weak:g} N m on each ball, anew 60 times a second. That is too weak to change where a ball
  goes, so the simulated motion is the same.
- *pushed*: the same with {strong:g} N m. The balls gather speed, meet more often and change their hosts.
- *replayed*: the record of *pushed* is replayed ([`control.replay`](client.md)): the same motion without the client.

{costs}
Slowest frames (p99): told against the client alone {told}; pushed against replayed {pushed}. Four nodes, an agent and a client
share the processors here, and all nodes begin their frames at the same moment. A frame is slow where one waits for another.
Nodes that replay a record read it first, begin late, and catch up. The next table therefore has the same world in one region,
whose node has a processor for itself:

{alone}
Here {alone_p50} at p50 and {alone_p99} at p99. Setpoints that came late: {late} of
{heard}; refused: {refused}. On the wire each torque takes 33 bytes: {per_step} bytes a state for {bodies} of them, to each node, in
{messages} messages.

### How soon it acts

A Python program observes each state of the demo on four nodes, paced by the clock (`World.observe`). It answers each with a force
on each of {answered} bodies, for a state that is so many states later. Each node counts as late what arrives after it has computed
that state. The lookahead K is {lookahead} in the demo; neighbours have to know of a force K states ahead, for their auras.

{delays}"""

KINDS = ("left alone", "looked at", "told", "pushed", "replayed")
KINDS_ALONE = ("looked at", "told")
WEAK_N_M, STRONG_N_M = 1e-4, 1.0


def scene(folder, bodies):
    """Balls 1.3 m apart that start in all directions, between four walls."""
    side = int(bodies**0.5 + 0.999)
    wall = 1.3 * side / 2 + 2

    def ball(i):
        x, y = (1.3 * (place - (side - 1) / 2) for place in (i % side, i // side))
        return (f"  - {{prototype: ball, position: [{x:.2f}, {y:.2f}, 0.4], "
                f"velocity: [{1.5 * np.cos(2.4 * i):.3f}, {1.5 * np.sin(2.4 * i):.3f}, 0]}}")

    rows = "\n".join(ball(i) for i in range(bodies))
    walls = "\n".join(f"  - {{name: wall {i}, shape: wall {along}, position: [{x:.2f}, {y:.2f}, 1]}}"
                      for i, (along, x, y) in enumerate((("y", wall, 0), ("y", -wall, 0), ("x", 0, wall), ("x", 0, -wall))))
    (folder / "balls.yaml").write_text(f"""name: balls
shapes:
  ball: {{sphere: {{radius: 0.4}}}}
  wall x: {{box: {{size: [{2 * wall:.2f}, 0.5, 2]}}}}
  wall y: {{box: {{size: [0.5, {2 * wall:.2f}, 2]}}}}
prototypes: {{ball: {{shape: ball, mass: 1, can_sleep: false}}}}
statics:
  - {{name: ground, shape: {{plane: {{}}}}}}
{walls}
bodies:
{rows}
""")
    files = {"four": "{layout: grid, rows: 2, columns: 2, cell: [30, 30]}", "one": "{count: 1}"}
    for name, regions in files.items():
        (folder / f"{name}.yaml").write_text(f"scene: balls.yaml\nregions: {regions}\ntime: {{sync: deterministic}}\n")
    return {name: folder / f"{name}.yaml" for name in files}


def frames(folder, first):
    """Of all nodes, in ms, from a state on."""
    times = []
    for line in (folder / "steps.csv").read_text().splitlines()[1:]:
        cells = line.split(",")
        if int(cells[1]) >= first:
            times.append(float(cells[2]))
    times.sort()
    return {"p50": times[len(times) // 2], "p99": times[int(len(times) * 0.99)]}


def one_run(options, file, kind):
    """Of a run; what was recorded of it is kept beside `file` if it was pushed, and given to one that is replayed."""
    record = file.parent / "setpoints.csv"
    with tempfile.TemporaryDirectory() as temporary:
        report = pathlib.Path(temporary) / "report"
        steps = int(60 * (options.seconds + 8))
        setting = [f"dds.domain={options.domain}"] + ([f"control.replay={record}"] if kind == "replayed" else [])
        run = subprocess.Popen([options.program, "launch", str(file), "--headless", "--steps", str(steps), "--report",
                                str(report), *[word for one in setting for word in ("--set", one)]],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(3)
        said = {}
        if kind in ("looked at", "told", "pushed"):
            bodies = 0 if kind == "looked at" else options.bodies
            torque = STRONG_N_M if kind == "pushed" else WEAK_N_M
            client = subprocess.run([options.client, str(file), str(options.domain), str(bodies), str(torque),
                                     str(options.seconds)],
                                    capture_output=True, text=True, check=True, timeout=options.seconds + 120)
            said = json.loads(client.stdout)
        if run.wait(options.seconds + 120) != 0:
            raise RuntimeError("the run has failed")
        if kind == "pushed":
            shutil.copy(report / "setpoints.csv", record)
        summary = json.loads((report / "summary.json").read_text())
        return {"kind": kind, **frames(report, 300), "real_time_factor": summary["real_time_factor"],
                "hand_offs": summary["migrations"], **said}


def answer_states(options, world, lead, states):
    """How many states it has answered, and what the nodes have counted meanwhile."""
    ids = world.bodies().ids[: options.answered]
    before = world.nodes()
    answered = 0
    with world.observe(bodies=ids) as observer:
        while answered < states:
            step = observer.next().step
            phase = ids.astype(float)[:, None] * (1.3, 2.1, 0.7) + 0.1 * step
            world.control(forces=(ids, 5 * np.sin(phase)), at=step + lead)
            answered += 1
    world.control(forces=(ids, None))
    time.sleep(1.5)
    after = world.nodes()

    def more(key):
        return sum(getattr(node, key) for node in after) - sum(getattr(node, key) for node in before)

    return {"lead": lead, "answered": answered, "heard": more("setpoints_heard"), "late": more("setpoints_late")}


def measure_delays(options):
    sys.path.insert(0, str(pathlib.Path(options.program).resolve().parent / "src/python"))
    import aurasim

    setting = {"dds.domain": options.domain}
    with aurasim.World.launch("launch_configs/demo.yaml", set=setting, program=str(options.program)) as world, \
            (options.out / "delays.jsonl").open("w") as out:
        lookahead = world.info().lookahead
        for lead in (1, 2, lookahead + 2, lookahead + 4):
            row = {"lookahead": lookahead, **answer_states(options, world, lead, 60 * options.seconds)}
            out.write(json.dumps(row) + "\n")
            print(json.dumps(row), flush=True)


def measure(options):
    with tempfile.TemporaryDirectory() as temporary, (options.out / "runs.jsonl").open("w") as out:
        files = scene(pathlib.Path(temporary), options.bodies)
        kinds = [("four", kind) for kind in KINDS] + [("one", kind) for kind in KINDS_ALONE]
        for repeat in range(options.repeats):
            for regions, kind in kinds:
                row = {"repeat": repeat, "regions": regions, **one_run(options, files[regions], kind)}
                out.write(json.dumps(row) + "\n")
                print(json.dumps(row), flush=True)


def write(options):
    rows = [json.loads(line) for line in (options.out / "runs.jsonl").read_text().splitlines()]

    def of(kind, key, regions="four"):
        return statistics.median(row[key] for row in rows if (row["regions"], row["kind"]) == (regions, kind))

    wanted = [("real-time factor", "real_time_factor"), ("hand-offs", "hand_offs"), ("frame p50, ms", "p50"),
              ("p99", "p99")]
    costs, alone = (
        table(["", *kinds], [[name, *[f"{of(kind, key, regions):.3g}" for kind in kinds]] for name, key in wanted
                             if regions == "four" or key != "hand_offs"])
        for regions, kinds in (("four", KINDS), ("one", KINDS_ALONE)))
    delays = [json.loads(line) for line in (options.out / "delays.jsonl").read_text().splitlines()]
    rows_of_delays = [[row["lead"] if row["lead"] <= 2 else f"{row['lead']} = K + {row['lead'] - row['lookahead']}",
                       row["answered"], row["heard"], row["late"]] for row in delays]
    steered = [row for row in rows if row["kind"] in ("told", "pushed")]

    def more(kind, base, key="p99", regions="four"):
        return f"{100 * (of(kind, key, regions) / of(base, key, regions) - 1):+.0f}%"

    text = TEXT.format(measured=measured_line(options.out), machine=machine_line(), bodies=options.bodies,
                       seconds=options.seconds, repeats=options.repeats, weak=WEAK_N_M, strong=STRONG_N_M, costs=costs,
                       late=sum(row["late"] for row in steered), heard=sum(row["heard"] for row in steered),
                       refused=sum(row["refused"] for row in steered), per_step=33 * options.bodies,
                       messages=-(-options.bodies // 800),
                       answered=options.answered, lookahead=delays[0]["lookahead"],
                       delays=table(["states later", "states answered", "heard by nodes", "late"], rows_of_delays).strip() + "\n",
                       alone=alone, alone_p50=more("told", "looked at", "p50", "one"),
                       alone_p99=more("told", "looked at", "p99", "one"), told=more("told", "looked at"), pushed=more("pushed", "replayed"))
    put_section(pathlib.Path("docs/results.md"), "control_cost", text)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default="build/release/aurasim")
    parser.add_argument("--client", default="build/release/control_client")
    parser.add_argument("--bodies", type=int, default=1000)
    parser.add_argument("--answered", type=int, default=20)
    parser.add_argument("--seconds", type=int, default=20)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--domain", type=int, default=75)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/control_cost"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    measure(options)
    measure_delays(options)
    write(options)


if __name__ == "__main__":
    main()
