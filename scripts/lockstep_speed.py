#!/usr/bin/python3
"""How many states a second a program gets in lock-step: twelve quadrupeds of twelve joints that trot, on one node and on
four. Each is asked for by step() alone, and by drive() of all 144 joints and step(). Prints a line of JSON for each, and
how long 500 calls of spawn() take. Compare two builds by turns on one machine: pass the program of each by --program.

    scripts/lockstep_speed.py [--program build/release/aurasim] [--seconds 5] [--layouts one,four]
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np

SOURCES = pathlib.Path(__file__).resolve().parents[1]
ROWS, COLUMNS = 3, 4
APART_M = 1.6
LAYOUTS = {"one": "{count: 1}", "four": "{layout: grid, rows: 2, columns: 2, cell: [3.2, 2.4]}"}


def scene(folder, program):
    """The launch file of each layout."""
    model = SOURCES / "tests" / "import" / "models" / "quadruped.urdf"
    subprocess.run([program, "import", str(model), "--out", str(folder / "quadruped.yaml")], check=True,
                   stdout=subprocess.DEVNULL)
    dogs = "\n".join(f"  - {{file: quadruped.yaml, name: dog{ROWS * column + row}, at: {{position: "
                     f"[{APART_M * (column - (COLUMNS - 1) / 2):.2f}, {APART_M * (row - (ROWS - 1) / 2):.2f}, 0.37]}}}}"
                     for column in range(COLUMNS) for row in range(ROWS))
    (folder / "pack.yaml").write_text(f"name: pack\nstatics: [{{name: ground, shape: {{plane: {{}}}}}}]\n"
                                      f"include:\n{dogs}\n")
    for name, regions in LAYOUTS.items():
        (folder / f"{name}.yaml").write_text(f"scene: pack.yaml\nregions: {regions}\n"
                                             "exchange: aura\ntime: {sync: deterministic, pace: none, lookahead: 1}\n")
    return {name: folder / f"{name}.yaml" for name in LAYOUTS}


def gait(robots):
    """Names of the twelve joints of a quadruped that trots in its place, and their positions in each state of a period."""
    class Heard:
        def drive(self, names, position, **_):
            self.names, self.positions = [name.removeprefix("dog") for name in names], position

    heard, table = Heard(), []
    dog = robots.Dog(0, None)
    for state in range(robots.Dog.PERIOD):
        dog.walk(heard, state, np.zeros(2), 0.0, np.zeros(2), 0.0)
        table.append(heard.positions)
    return heard.names, np.array(table)


def cpu_s():
    """Of this process and those below it, by what they are: client, agent, launch, node."""
    stats = {}
    for entry in pathlib.Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            fields = (entry / "stat").read_text().rsplit(")", 1)[1].split()
            words = (entry / "cmdline").read_bytes().decode().split("\0")
        except OSError:
            continue
        stats[int(entry.name)] = (int(fields[1]), (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK"), words)
    spent, mine = {"client": 0.0}, {os.getpid()}
    for pid in sorted(stats):
        parent, seconds, words = stats[pid]
        if pid != os.getpid() and parent not in mine:
            continue
        mine.add(pid)
        what = "client" if pid == os.getpid() else words[1] if len(words) > 1 else "?"
        spent[what] = spent.get(what, 0.0) + seconds
    return spent


def rate(seconds, tick):
    """Ticks a second, the usual and the slowest of them in ms, and the processor's ms for each that processes have spent;
    after half a second for the machine to settle."""
    end = time.monotonic() + 0.5
    while time.monotonic() < end:
        tick()
    before = cpu_s()
    times = [time.monotonic()]
    while times[-1] < times[0] + seconds:
        tick()
        times.append(time.monotonic())
    after = cpu_s()
    spans = np.diff(times)
    return {"a_second": round(len(spans) / (times[-1] - times[0]), 1), "p50_ms": round(1e3 * np.median(spans), 3),
            "p99_ms": round(1e3 * float(np.percentile(spans, 99)), 3),
            "cpu_ms": {what: round(1e3 * (after[what] - before.get(what, 0)) / len(spans), 3) for what in after}}


def measure(options, file, layout, aurasim, names, table):
    def say(what, **row):
        load = os.getloadavg()[0]
        print(json.dumps({"layout": layout, "what": what, **row, "load": round(load, 1)}), flush=True)

    setting = {"dds.domain": options.domain}
    with aurasim.World.launch(file, set=setting, program=str(options.program), paused=True) as world:
        dogs = ROWS * COLUMNS
        joints = [f"dog{dog}{name}" for dog in range(dogs) for name in names]
        say("step", **rate(options.seconds, world.step))
        state = world.bodies().step

        def tick():
            nonlocal state
            world.drive(joints, position=np.tile(table[state % len(table)], dogs), stiffness=300, damping=8,
                        max_effort=40)
            state = world.step().step

        say("drive and step", **rate(options.seconds, tick))
        late = sum(node.setpoints_late + node.setpoints_refused for node in world.nodes())
        if late:
            raise SystemExit(f"{late} setpoints were late or refused")
        if options.spawns:
            begin = time.monotonic()
            for i in range(options.spawns):
                world.spawn(aurasim.Shape.sphere(0.05), position=(0.3 * (i % 20) - 3, 0.3 * (i // 20) - 4, 30), mass=0.1)
                if i % 250 == 249:
                    world.step()  # a state takes no more than 300
            say(f"{options.spawns} spawns", seconds=round(time.monotonic() - begin, 3))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=pathlib.Path, default=pathlib.Path("build/release/aurasim"))
    parser.add_argument("--seconds", type=float, default=5)
    parser.add_argument("--layouts", default="one,four")
    parser.add_argument("--spawns", type=int, default=500)
    parser.add_argument("--domain", type=int, default=76)
    options = parser.parse_args()
    options.program = options.program.resolve()
    sys.path[:0] = [str(options.program.parent / "src/python"), str(SOURCES / "src/client/examples")]
    import aurasim
    import robots

    names, table = gait(robots)
    with tempfile.TemporaryDirectory() as temporary:
        files = scene(pathlib.Path(temporary), str(options.program))
        for layout in options.layouts.split(","):
            measure(options, files[layout], layout, aurasim, names, table)


if __name__ == "__main__":
    main()
