#!/usr/bin/env python3
"""What a start and a state cost each node, the more nodes there are on one host.
    scripts/many_processes.py [--nodes 4,9,16,25,36,64] [--exchanges aura,coupled] [PROGRAM=build/release/aurasim]
600 bodies rain on a grid of regions of 20 m, one process for each, started by `aurasim launch` over Fast DDS. CPU: user and
system time of all processes. Appends the suite many_processes to docs/results. About 3 minutes on 2 cores. Fails where a run
does not end well, or where auras and coupled regions do not end in the same bits."""
import argparse
import csv
import math
import pathlib
import random
import resource
import subprocess
import sys
import tempfile
import time

from stored_rows import ROOT, Rows, build

BODIES, REGION_M, STATES = 600, 20, 120
SCENE = """name: rain
shapes: {ball: {sphere: {radius: 0.3}}, cuboid: {box: {size: [0.5, 0.5, 0.5]}}}
prototypes: {ball: {shape: ball, mass: 1}, cuboid: {shape: cuboid, mass: 1}}
statics: [{name: ground, shape: {plane: {normal: [0, 0, 1]}}}]
bodies:
"""


def world(folder, side):
    """Writes a scene, and a launch file that cuts it into side x side regions."""
    chance = random.Random(7)
    half = REGION_M * side / 2
    rows = [f"  - {{prototype: {chance.choice(['ball', 'cuboid'])}, "
            f"position: [{chance.uniform(-half, half):.2f}, {chance.uniform(-half, half):.2f}, {chance.uniform(1, 9):.2f}], "
            f"velocity: [{chance.uniform(-4, 4):.2f}, {chance.uniform(-4, 4):.2f}, 0]}}\n" for _ in range(BODIES)]
    (folder / "scene.yaml").write_text(SCENE + "".join(rows))
    (folder / "launch.yaml").write_text(
        f"scene: scene.yaml\nregions: {{layout: grid, rows: {side}, columns: {side}, cell: [{REGION_M}, {REGION_M}]}}\n"
        "time: {pace: none, sync: deterministic}\nphysics: {block: 10, threads: 1}\n")


def run(program, folder, exchange, states):
    """Returns the CPU seconds of all processes, the seconds by the clock, and the hash of the last state."""
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    done = subprocess.run([program, "launch", folder / "launch.yaml", "--headless", "--steps", str(states), "--report", folder / "report",
                           "--set", f"exchange={exchange}"], capture_output=True, text=True, timeout=600, check=False)
    after, ended = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    if done.returncode != 0:
        raise RuntimeError(f"{exchange}: ended with {done.returncode}: {done.stderr[-500:]}")
    with (folder / "report" / "state_hash.csv").open() as file:
        end = list(csv.DictReader(file))[-1]["hash"]
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, ended - begun, end


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("program", nargs="?")
    parser.add_argument("--nodes", default="4,9,16,25,36,64")
    parser.add_argument("--exchanges", default="aura,coupled")
    options = parser.parse_args()
    if options.program is None:
        build()
    program = options.program or ROOT / "build/release/aurasim"
    rows, different = Rows(), []
    for nodes in map(int, options.nodes.split(",")):
        ends = set()
        for exchange in options.exchanges.split(","):
            with tempfile.TemporaryDirectory() as name:
                folder = pathlib.Path(name)
                world(folder, math.isqrt(nodes))
                start_s, start_wall_s, _ = run(program, folder, exchange, 1)
                whole_s, whole_wall_s, end = run(program, folder, exchange, STATES)
            ends.add(end)
            a_state_ms = 1e3 * (whole_s - start_s) / (STATES - 1) / nodes
            case = f"{exchange}/{nodes}"
            rows.add(case, "CPU of a start, all nodes", start_s, "s")
            rows.add(case, "a start by the clock", start_wall_s, "s")
            rows.add(case, "CPU of a state, each node", a_state_ms, "ms")
            rows.add(case, "a state by the clock", 1e3 * (whole_wall_s - start_wall_s) / (STATES - 1), "ms")
            print(f"{exchange}, {nodes} nodes: a start takes {start_s:.1f} s CPU and {start_wall_s:.1f} s, "
                  f"a state {a_state_ms:.2f} ms CPU of each node", flush=True)
        if len(ends) > 1:
            different.append(nodes)
    if different:
        sys.exit(f"not the same bits at the end: {different} nodes")
    rows.store("many_processes")


if __name__ == "__main__":
    main()
