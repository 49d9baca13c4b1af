#!/usr/bin/python3
"""Writes docs/results.md#same_bits from what scripts/same_bits.sh has left.

    scripts/write_same_bits.py DIR [--steps N] [--out docs]

A network that DIR has no rows of keeps its part of the page, with what that was measured with.
"""
import argparse
import json
import pathlib
import re

from page_sections import put_section, section_of
from report_parts import machine_line, measured_line, table

INTRODUCTION = """## The same bits on any number of nodes

Written by `scripts/same_bits.sh`; do not edit. Each part says with which commit and build it was measured. Real processes
over DDS on one host, `deterministic`, `time.pace=none`. Each row is a run of {steps:,} steps whose state hash is compared
in every step with the run on one node. Machine: {machine}.

"""
NETWORKS = {
    "good": ("On a good network", ""),
    "bad": ("On a bad network", "Every datagram that a node sends is delayed by 16 ms, give or take 5 ms, and 10% of them "
            "are dropped.\n\n"),
}
ALSO = """### Also in CI

Every scene in virtual time, three cuts each, over a network that loses and copies 5%
(`tests/cluster/shipped_scenes_test.cpp`); runs with orders of clients (`tests/cluster/orders_test.cpp`); 1,000 seeds of
thrown bodies (`ctest -L long`).

"""


def part_of(page, heading):
    """What the page says under a heading now, or nothing."""
    found = re.search(rf"^### {re.escape(heading)}\n\n(.*?)(?=^### |\Z)", page, re.DOTALL | re.MULTILINE)
    return found.group(1) if found else "Not measured.\n\n"


def rows_of(file):
    """The last row of each run: one that failed may have been run again."""
    rows = {}
    for line in file.read_text().splitlines():
        cells = [c.strip() for c in line.strip("|").split("|")]
        rows[tuple(cells[:4])] = cells
    return [rows[key] for key in sorted(rows, key=lambda k: (k[0], int(k[3]), int(k[1])))]


def network_part(directory, page, network, steps):
    heading, text = NETWORKS[network]
    file = directory / f"{network}-{steps}.md"
    if not file.exists():
        return f"### {heading}\n\n" + part_of(page, heading)
    rows = rows_of(file)
    equal = sum(1 for r in rows if r[-1].startswith("equal"))
    redos = sum(int(r[-2]) for r in rows if r[-2].isdigit())
    return (f"### {heading}\n\n{measured_line(directory)}\n\n{text}{equal} of {len(rows)} equal; "
            f"{redos} redos in {steps * len(rows):,} steps.\n\n"
            + table(["scene", "nodes", "network", "repetition", "hand-offs", "redos", "against one node"], rows))


def cost_part(directory):
    runs = {b["name"]: b for b in json.loads((directory / "bench.json").read_text())["benchmarks"]}

    def cpu(name):
        return f"{runs[name]['cpu_time']:.3g} {runs[name]['time_unit']}"

    plain = next(b for name, b in runs.items() if "plain_bullet" in name)
    return "### What it costs\n\n" + measured_line(directory) + f"""

CPU time, from `build/release/aurasim_bench --benchmark_filter='hand_off/|plain_bullet'`, one run:

""" + table(["", ""], [
        ["hand-off of a touching cluster of 20: encode", cpu("encode_hand_off/20")],
        ["decode", cpu("decode_hand_off/20")],
        ["adopt and release", cpu("hand_off/bodies:20/steps_late:0")],
        ["the same, with a catch-up of 3 steps", cpu("hand_off/bodies:20/steps_late:3")],
        ["a step of 5,000 awake bodies at 4 substeps, over what Bullet takes as it comes",
         f"{plain['ours_over_plain']:.2f} times"]])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory", type=pathlib.Path)
    parser.add_argument("--steps", type=int, default=1800)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path(__file__).parent.parent / "docs")
    arguments = parser.parse_args()
    path = arguments.out / "results.md"
    page = section_of(path, "same_bits")
    text = INTRODUCTION.format(machine=machine_line(), steps=arguments.steps)
    for network in NETWORKS:
        text += network_part(arguments.directory, page, network, arguments.steps)
    text += ALSO + cost_part(arguments.directory)
    put_section(path, "same_bits", text)


if __name__ == "__main__":
    main()
