#!/usr/bin/env python3
"""What it costs to steer 1,000 bodies: balls that roll about over four regions, left alone and with a torque on each of
them, 60 times a second, by one client; by turns. Writes DIR/runs.jsonl, and the medians as the suite
control_cost. About 15 minutes on 2 cores, where nothing else runs."""
import argparse
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

import numpy as np

from stored_rows import Rows, build

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
        (folder / f"{name}.yaml").write_text(f"scene: balls.yaml\nregions: {regions}\nexchange: aura\ntime: {{sync: deterministic}}\n")
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


WANTED = (("real-time factor", "real_time_factor", "1"), ("hand-offs", "hand_offs", "1"), ("frame p50", "p50", "ms"),
          ("frame p99", "p99", "ms"), ("setpoints heard", "heard", "1"), ("setpoints late", "late", "1"),
          ("setpoints refused", "refused", "1"))


def store(options):
    rows = Rows()
    for line in (options.out / "runs.jsonl").read_text().splitlines():
        run = json.loads(line)
        for name, key, unit in WANTED:
            rows.add(f"{run['regions']}/{run['kind']}", name, run.get(key), unit)
    for line in (options.out / "delays.jsonl").read_text().splitlines():
        run = json.loads(line)
        lead = run["lead"] if run["lead"] <= 2 else f"{run['lead']} = K + {run['lead'] - run['lookahead']}"
        for name, key in (("states answered", "answered"), ("heard by nodes", "heard"), ("late", "late")):
            rows.add(f"states later/{lead}", name, run[key])
    rows.store("control_cost")


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
    build("control_client", "aurasim_python")
    measure(options)
    measure_delays(options)
    store(options)


if __name__ == "__main__":
    main()
