#!/usr/bin/env python3
"""What hand-offs and saved worlds cost: CPU times of build/release/aurasim_bench, stored as the suite bench.

    scripts/bench_costs.py
"""
import json
import subprocess

from stored_rows import ROOT, Rows, build

HAND_OFF = {"encode_hand_off/20": "hand-off of a touching cluster of 20: encode", "decode_hand_off/20": "decode",
            "hand_off/bodies:20/steps_late:0": "adopt and release",
            "hand_off/bodies:20/steps_late:3": "the same, with a catch-up of 3 steps"}
WORLD = ("capture", "encode", "decode", "put_back")


def main():
    build("aurasim_bench")
    said = subprocess.run([ROOT / "build" / "release" / "aurasim_bench", "--benchmark_filter=hand_off/|plain_bullet|_world/",
                           "--benchmark_format=json"], check=True, capture_output=True, text=True)
    rows = Rows()
    for bench in json.loads(said.stdout)["benchmarks"]:
        name, time = bench["name"], (bench["cpu_time"], bench["time_unit"])
        what, _, bodies = name.partition("_world/")
        if name in HAND_OFF:
            rows.add(f"hand-off/{HAND_OFF[name]}", "CPU time", *time)
        elif "plain_bullet" in name:
            rows.add("hand-off/a step of 5,000 awake bodies at 4 substeps, over what Bullet takes as it comes", "ratio",
                     bench["ours_over_plain"], "ratio")
        elif what in WORLD:
            rows.add(f"world/{bodies} bodies", what.replace("_", " "), *time)
            if what == "encode":
                rows.add(f"world/{bodies} bodies", "contact points", bench["points"])
                rows.add(f"world/{bodies} bodies", "bytes", bench["bytes"], "B")
    rows.store("bench")


if __name__ == "__main__":
    main()
