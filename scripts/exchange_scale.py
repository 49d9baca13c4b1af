#!/usr/bin/env python3
"""How much of a step's work is left for each node when a world is cut into more regions, with auras and with coupled regions.
    scripts/exchange_scale.py [--worlds wide,heap] [--nodes 1,2,4] [--exchanges aura,coupled] [PROGRAM=build/release/aurasim]
Runs each world as real processes over Fast DDS and appends the suite exchange_scale to docs/results. *CPU*: user and system
time of the busiest node's process, all its threads, for a state: of a run of all states less that of a run of one state. So a
machine with fewer cores than nodes can measure it too. What a node waits for its neighbours is not in it. About 15 minutes on
2 cores. Fails where a run does not end well, or where two runs of a world do not end in the same bits."""
import argparse
import csv
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

from stored_rows import ROOT, Rows, build

SCENE = """name: {name}
shapes:
  ball: {{sphere: {{radius: 0.3}}}}
  cuboid: {{box: {{size: [0.3, 0.3, 1.0]}}}}
  capsule: {{capsule: {{radius: 0.3, total_height: 2}}}}
prototypes:
  ball: {{shape: ball, mass: 1, can_sleep: false}}
  cuboid: {{shape: cuboid, mass: 1, can_sleep: false}}
  capsule: {{shape: capsule, mass: 1, can_sleep: false}}
statics:
  - {{name: ground, shape: {{plane: {{normal: [0, 0, 1]}}}}}}
injectors:
  - {{name: rain, seed: 1, rate: {rate}, count: {count}, volume: {volume}, velocity: {velocity}, prototypes: [ball, cuboid, capsule],
     random_orientation: true}}
"""
# Nothing touches more than a few others in `wide`. In `heap` everything touches everything, over the corner of the regions.
WORLDS = {
    "wide": {"states": 400, "layout": lambda n: f"{{layout: columns, count: {n}, width: {160 / n}}}",
             "scene": {"rate": 2000, "count": 8000, "volume": "{center: [0, 0, 12], size: [155, 100, 14]}",
                       "velocity": "{min: [-10, -10, -10], max: [10, 10, 0]}"}},
    "heap": {"states": 400, "layout": lambda n: (f"{{layout: columns, count: {n}, width: 20}}" if n < 4 else
                                                 "{layout: grid, rows: 2, columns: 2, cell: [20, 20]}"),
             "scene": {"rate": 1000, "count": 4000, "volume": "{center: [0, 0, 12], size: [26, 26, 8]}",
                       "velocity": "{min: [-3, -3, -6], max: [3, 3, 0]}"}},
}
LAUNCH = """scene: scene.yaml
time: {pace: none, sync: deterministic, lookahead: 1, substeps: 4}
physics: {solver: soft_step, threads: 1}
tolerances: {speed: 40, latency: 0.002, frame: 0.014}
"""


def cpu_seconds_of(program, folder, world, exchange, nodes, states):
    """CPU seconds of each node's process."""
    words = ["--set", f"regions={WORLDS[world]['layout'](nodes)}", "--set", f"exchange={exchange}", "--set",
             f"dds.profiles={ROOT / 'qos/aurasim.xml'}", "--steps", str(states), "--start-time-out", "120"]
    processes = [subprocess.Popen([program, "node", folder / "launch.yaml", "--region", str(region), "--report", folder / f"{region}", *words],
                                  stdout=subprocess.DEVNULL, stderr=(folder / "log").open("a")) for region in range(nodes)]
    found, deadline = {}, time.monotonic() + 900
    while len(found) < nodes:
        pid, status, usage = os.wait4(-1, os.WNOHANG)
        if pid == 0:
            if time.monotonic() > deadline:
                for process in processes:
                    if process.pid not in found:
                        process.send_signal(signal.SIGKILL)
                raise RuntimeError(f"{world}, {exchange}, {nodes} nodes: not done in 15 minutes")
            time.sleep(0.05)
            continue
        found[pid] = usage.ru_utime + usage.ru_stime
        if status != 0:
            raise RuntimeError(f"{world}, {exchange}, {nodes} nodes: ended with {status}: {(folder / 'log').read_text()[-500:]}")
    return list(found.values())


def hash_of_last_state(folder, nodes):
    """Sum of the nodes' hashes of the last state, which is the hash of the world."""
    total = 0
    for region in range(nodes):
        with (folder / str(region) / f"region_{region}" / "state_hash.csv").open() as file:
            total += int(list(csv.DictReader(file))[-1]["hash"], 16)
    return total % 2**64


def measure(program, world, exchange, nodes):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "scene.yaml").write_text(SCENE.format(name=world, **WORLDS[world]["scene"]))
        (folder / "launch.yaml").write_text(LAUNCH)
        states = WORLDS[world]["states"]
        begun = cpu_seconds_of(program, folder, world, exchange, nodes, 1)
        whole = cpu_seconds_of(program, folder, world, exchange, nodes, states)
        start = sum(begun) / nodes
        return [1e3 * (seconds - start) / states for seconds in whole], hash_of_last_state(folder, nodes)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("program", nargs="?")
    for name, default in (("worlds", "wide,heap"), ("nodes", "1,2,4"), ("exchanges", "aura,coupled")):
        parser.add_argument(f"--{name}", default=default)
    options = parser.parse_args()
    if options.program is None:
        build()
    program = options.program or ROOT / "build/release/aurasim"
    rows, ends = Rows(), {}
    for world in options.worlds.split(","):
        alone = None
        for nodes in map(int, options.nodes.split(",")):
            for exchange in ["aura"] if nodes == 1 else options.exchanges.split(","):
                each, end = measure(program, world, exchange, nodes)
                ends.setdefault(world, set()).add(end)
                alone = alone or max(each)
                for kind in options.exchanges.split(",") if nodes == 1 else [exchange]:
                    rows.add(f"{world}/{kind}/{nodes}", "CPU of the busiest node", max(each), "ms")
                    rows.add(f"{world}/{kind}/{nodes}", "CPU of all nodes", sum(each), "ms")
                    rows.add(f"{world}/{kind}/{nodes}", "busiest, of one node's", max(each) / alone, "ratio")
                print(f"{world}, {exchange}, {nodes} nodes: busiest {max(each):.2f} ms, all {sum(each):.2f} ms, "
                      f"{alone / max(each):.2f} times less than one node", flush=True)
            rows.add(f"{world}/ideal/{nodes}", "CPU of the busiest node", alone / nodes, "ms")
    different = [world for world, found in ends.items() if len(found) > 1]
    if different:
        sys.exit(f"not the same bits at the end: {', '.join(different)}")
    rows.store("exchange_scale")


if __name__ == "__main__":
    main()
