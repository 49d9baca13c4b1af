#!/usr/bin/python3
"""Writes docs/results.md#saved_worlds from what scripts/saved_worlds.sh has left.

    scripts/write_saved_worlds.py DIR [--steps N] [--out docs]
"""
import argparse
import json
import pathlib

from page_sections import put_section
from report_parts import machine_line, measured_line, table

TEXT = """## Saved worlds

{measured}

Written by `scripts/saved_worlds.sh`; do not edit. {machine}.

### Every shipped scene

Saved in mid-run by 4 nodes over DDS on one host (`deterministic`, {steps} steps), and gone on from by 1, 2, 4 and 9: is the hash of
every later state that of the run that was never stopped? *Under way*: bodies that had left one node and not reached the
other. *Bytes*: of the one file. {equal} of {runs} runs equal.

{scenes}### Random worlds

In virtual time, saved in state 170 on their own regions and gone on from on 1, 2, 4 and 9 nodes, each through the bytes of
a file; every state from there on has to have the bits of the run that went on, and that those of one node.

{seeds}### Nodes that die

The same worlds, and three times in each run a node dies, in virtual time: it loses all that it had in memory. All go back to
the newest state (every 60) of which everybody's part is kept elsewhere, with the orders that the others know, and compute
on from there. Every state has to have the bits of one node that nothing happened to.

{deaths}### What it costs

CPU time, `build/release/aurasim_bench --benchmark_filter=_world/`; boxes in loose piles of five. A step pays for *capture*; the
file is made by a thread beside the run. *Put back*: into an empty world.

{costs}"""


def scene_rows(directory):
    lines = (directory / "scenes.md").read_text().splitlines()
    rows = {}
    for line in lines:
        cells = [c.strip() for c in line.strip("|").split("|")]
        rows[cells[0]] = cells
    return [rows[name] for name in sorted(rows)]


def seeds_row(directory, what, network):
    sums = json.loads((directory / f"{what}_{network}" / "summary.json").read_text())
    return [network, sums["seeds"], sums["differ"], sums["late"], sums["missed"]]


def cost_rows(directory):
    runs = {b["name"]: b for b in json.loads((directory / "bench.json").read_text())["benchmarks"]}
    rows = []
    for bodies in sorted({int(name.split("/")[1]) for name in runs}):
        encode = runs[f"encode_world/{bodies}"]
        rows.append([f"{bodies:,}", f"{encode['points']:,.0f}"]
                    + [f"{runs[f'{what}_world/{bodies}']['cpu_time']:.2f}"
                       for what in ("capture", "encode", "decode", "put_back")]
                    + [f"{encode['bytes']:,.0f}"])
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory", type=pathlib.Path)
    parser.add_argument("--steps", type=int, default=600)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path(__file__).parent.parent / "docs")
    arguments = parser.parse_args()
    rows = scene_rows(arguments.directory)
    verdicts = [cell for row in rows for cell in row[-4:]]
    text = TEXT.format(
        measured=measured_line(arguments.directory), machine=machine_line(), steps=arguments.steps,
        equal=verdicts.count("equal"), runs=len(verdicts),
        scenes=table(["scene", "state", "bodies", "under way", "contact points", "bytes", "1 node", "2", "4", "9"], rows),
        **{what: table(["network", "seeds", "differ", "late", "missed"],
                       [seeds_row(arguments.directory, what, network) for network in ("good", "bad")])
           for what in ("seeds", "deaths")},
        costs=table(["bodies", "contact points", "capture, ms", "encode, ms", "decode, ms", "put back, ms", "bytes"],
                    cost_rows(arguments.directory)))
    put_section(arguments.out / "results.md", "saved_worlds", text)


if __name__ == "__main__":
    main()
