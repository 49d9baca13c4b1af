#!/usr/bin/env python3
"""Prints what one exchange of coupled regions takes on this host, by the nodes' own counters, as a table.
    scripts/exchange_latency.py [--steps N] [--nodes 2,4,16] [--set KEY=VALUE ...] [PROGRAM=build/release/aurasim]
In the scene a plate lies on four bricks over each corner of regions, so that nearly all of a step is exchanges. A time is
what the slowest node counts from the first parcel that it posts in an exchange to the last that it fetches, less what it
computes in between. With --set dds.impair.loss=0.1 a fifth of the exchanges of two nodes lose a message, so p90 is what
such an exchange takes: how soon a lost parcel has come after all."""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

REGIONS = {2: "{layout: columns, count: 2, width: 8}", 4: "{layout: grid, rows: 2, columns: 2, cell: [8, 8]}",
           16: "{layout: grid, rows: 4, columns: 4, cell: [8, 8]}"}
ROOT = pathlib.Path(__file__).resolve().parent.parent
SCENE = """name: plates
materials: {stone: {friction: 0.6}}
shapes: {plate: {box: {size: [3, 3, 0.2]}}, brick: {box: {size: [1, 1, 0.5]}}}
prototypes:
  plate: {shape: plate, mass: 2, material: stone, can_sleep: false}
  brick: {shape: brick, mass: 1, material: stone, can_sleep: false}
statics: [{name: ground, material: stone, shape: {plane: {normal: [0, 0, 1]}}}]
bodies:
"""


def write_scene(folder):
    lines = [SCENE]
    for x in (-8, 0, 8):
        for y in (-8, 0, 8):
            lines.append(f"  - {{prototype: plate, position: [{x + 0.1}, {y + 0.1}, 0.6]}}\n")
            lines += [f"  - {{prototype: brick, position: [{x + a}, {y + b}, 0.25]}}\n" for a in (-1, 1) for b in (-1, 1)]
    (folder / "scene.yaml").write_text("".join(lines))
    (folder / "launch.yaml").write_text(f"scene: scene.yaml\nregions: {REGIONS[4]}\nphysics: {{block: 4, threads: 1}}\n"
                                        f"time: {{pace: none}}\nexchange: coupled\ndds: {{profiles: "
                                        f"{ROOT / 'qos/aurasim.xml'}}}\n")


def measure(program, nodes, steps, settings):
    """Exchanges of the node whose median is the longest, and the exchanges of a step."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write_scene(folder)
        command = [program, "launch", str(folder / "launch.yaml"), "--headless", "--steps", str(steps), "--report",
                   str(folder / "report"), "--start-time-out", "300", "--set", f"regions={REGIONS[nodes]}"]
        for setting in settings:
            command += ["--set", setting]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, timeout=900)
        summary = json.loads((folder / "report" / "summary.json").read_text())
    slowest = max((node["exchanges"] for node in summary["nodes"]), key=lambda times: times["p50_ms"])
    return slowest, slowest["count"] / steps


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("program", nargs="?", default=str(ROOT / "build/release/aurasim"))
    parser.add_argument("--steps", type=int, default=600)
    parser.add_argument("--nodes", default="2,4,16")
    parser.add_argument("--set", action="append", default=[], dest="settings", metavar="KEY=VALUE")
    options = parser.parse_args()
    print("| nodes | exchanges of a step | p50, us | p90, us | p99, us | longest, us |\n|---|---|---|---|---|---|")
    for nodes in map(int, options.nodes.split(",")):
        times, of_a_step = measure(options.program, nodes, options.steps, options.settings)
        us = [f"{1e3 * times[name]:.0f}" for name in ("p50_ms", "p90_ms", "p99_ms", "max_ms")]
        print(f"| {nodes} | {of_a_step:.1f} | " + " | ".join(us) + " |", flush=True)
    print(f"{os.cpu_count()} cores", file=sys.stderr)


if __name__ == "__main__":
    main()
