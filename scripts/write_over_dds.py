#!/usr/bin/python3
"""Writes docs/results.md#correctness_over_dds from the results of the collision and loss experiments over DDS.

    scripts/write_over_dds.py COLLISION_DIR LOSS_DIR [--out DIR]
"""
from page_sections import put_section
from report_parts import measured_line, table
from write_correctness import SERIES, pairs_table, read_results, targets_table

INTRODUCTION = """## Collisions over DDS, in real time

{measured}

Written by `scripts/correctness_over_dds.sh`; do not edit. A part of the experiments of [correctness.md](correctness.md) ({repeats} pairs
for each of 4 values of every series), with real nodes that stay up between trials: each has a thread and a DDS
participant of its own, and talks over UDP on loopback.

- Each node paces its steps by the wall clock, with a phase of its own. A frame lasts as long as it is told to (a thread
  sleeps), and its messages leave at its end. Latency and loss are made by the impaired transport (`dds/impairment.h`);
  what is lost is repeated by DDS itself.
- Ten pairs fly side by side, 2 km apart: as many worlds in one. A broken promise counts for all ten, so "flagged" says
  less here than in virtual time.
- The control is the same pair on one node, in virtual time.

"""


def series_table(summary):
    wanted = [("none", "bounded"), ("tight", "free_running"), ("swept", "free_running"), ("swept", "bounded")]
    out = []
    for series in dict.fromkeys(r["series"] for r in summary["by"]):
        for kept in (True, False):
            row = [SERIES[series], "within" if kept else "beyond"]
            for aura, sync in wanted:
                found = [r for r in summary["by"] if (r["series"], r["aura"], r["sync"], r["tolerance_kept"])
                         == (series, aura, sync, kept)]
                row.append(f"{found[0]['late']} / {found[0]['missed']} of {found[0]['trials']}" if found else "")
            out.append(row)
    return table(["tolerance", ""] + [f"{a}, {s}: late / missed" for a, s in wanted], out)


def loss_table(summary):
    out = []
    for r in summary["by"]:
        if r["aura"] != "central":
            out.append([f"{r['value']:g}%", r["aura"], r["sync"], r["trials"], r["late"], r["missed"], r["thrashed"],
                        r["late_without_violation"] + r["missed_without_violation"],
                        f"{r['mean_slow_down']:.3f} / {r['most_slow_down']:.3f}"])
    return table(["lost", "aura", "sync", "N", "late", "missed", "thrashed", "wrong, no violation",
                  "time taken over simulated: mean / most"], sorted(out, key=lambda row: (row[1], row[2], float(row[0][:-1]))))


def main():
    arguments, collision, loss = read_results(__doc__)
    text = INTRODUCTION.format(measured=measured_line(arguments.collision.parent), repeats=collision["repeats"])
    text += "### What has to hold, and what was found\n\n" + targets_table(collision)
    text += "Packet loss:\n\n" + targets_table(loss)
    text += "### By series\n\n" + series_table(collision)
    text += "### By aura and sync\n\n" + pairs_table(collision)
    text += "### Packet loss\n\n" + loss_table(loss)
    put_section(arguments.out / "results.md", "correctness_over_dds", text)


if __name__ == "__main__":
    main()
