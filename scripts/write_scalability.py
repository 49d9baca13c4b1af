#!/usr/bin/python3
"""Writes docs/scalability.md from the results of the scalability and bandwidth experiments.

    scripts/write_scalability.py DIR [--out docs]

Reads DIR/long, DIR/long_k1, DIR/short, DIR/bandwidth and, if they are there, DIR/wall and DIR/wall_k1.
"""
import argparse
import csv
import json
import pathlib
import shutil
import statistics

from report_parts import machine_line, measured_line, table

FIGURES = [("long", "fig_5.2_frame_columns"), ("short", "fig_5.5_frame_corners"), ("long", "fig_5.6_hand_offs_columns"),
           ("long", "fig_5.8_updates_columns"), ("long", "fig_5.11_cost_over_bodies_log"),
           ("long", "fig_5.14_cost_per_body"), ("long", "fig_5.17_speed_up"), ("short", "percolation_largest_cluster"),
           ("short", "percolation_frame")]
THESIS = {2: 1.74, 4: 3.40, 8: 4.22}
WANTED = {2: 3, 4: 7, 8: 14}
WALLS = {2: "wall", 1: "wall_k1"}  # folders by K
STEP_MS = 1000 / 60

INTRODUCTION = """# How much faster are several nodes?

{measured}

Written by `scripts/scalability.sh`; do not edit. Machine: {machine}. Every number is of this machine and these seeds
(1 and 2, plus 10 for each repeat); what watches the whole rain are medians of {repeats} runs with other bodies, but for
K = 2 by the wall clock; the rest are single runs. The sections after *Cuts*, and whatever compares auras, watch the
first 20 s and 3,200 bodies only.

## What is measured

- **The rain** of A. Brown's thesis, section 5.1 (`launch_configs/columns_rain.yaml`): 160 bodies a second for 60 s,
  9,600 in all, half of them near the boundaries between regions of 80 m and half in the regions' middles; one substep,
  tolerances of 32 m/s, 2 ms and 15 ms, so a lookahead of K = 2 steps. A frame and a message then take 0.3 ms more than
  a step. Whoever promises 14 ms instead of 15 gets K = 1: everything looks a third as far ahead, and less is kept
  together. So the columns are shown for both.
- **ms CPU**: all nodes of a run compute in virtual time in one thread, and each step of each node is measured by the
  thread's CPU clock. So the numbers are *work*, not waiting, and more nodes than cores can be compared. A frame is
  physics, protocol (auras, clusters, hand-offs), transport, and the watch for late collisions, which is for the report.
- **Transport**: messages are really encoded, serialised as CDR, deserialised, checked and decoded
  (`src/lab/wire_post.h`); sockets and RTPS are not in it.
- **Frame** of a run with several nodes: the slowest node in each step. *max*: of all steps. *p95*: the largest 95th
  percentile of any window of 5 s. *last*: mean of the last 5 s.
- **In real time**: with so many bodies, and with fewer, the mean frame of every 5 s was within a step of 16.7 ms.
- Two worlds. **columns**: the rain follows the regions of the run, as in the thesis, so more nodes have a larger and
  thinner world; one node gets everything into one large cluster. **cuts**: one world of 8 columns, cut into 1, 2, 4 and 8; the
  bodies are the same and only the cuts differ.
- **back**: share of the handed over bodies that return to where they came from within a second. **hosted**: bodies on
  the fullest node over the mean, at the worst end of a window.

"""


def of(runs, series, **wanted):
    chosen = [r for r in runs if r["series"] == series and all(r[k] == v for k, v in wanted.items())]
    return sorted(chosen, key=lambda r: (r["nodes"], r["aura"], r["repeat"]))


def share(part, whole):
    return f"{100 * part / whole:.1f}%" if whole and part is not None else "-"


def run_row(r, *first):
    return list(first) + [f"{r['frame_max_ms']:.1f}", f"{r['frame_p95_ms']:.1f}", f"{r['last_frame_ms']:.1f}",
                          f"{r['physics_ms']:.1f}", f"{r['protocol_ms']:.2f}", f"{r['transport_ms']:.2f}",
                          f"{100 * r['overhead_share']:.1f}%", r["projecting"], r["hand_offs"],
                          share(r["returns"], r["hand_offs"]), r["largest_cluster"], f"{r['most_hosted_share']:.2f}",
                          r["late"], r["violations"]]


PHASES = ["physics_ms", "protocol_ms", "transport_ms", "watch_ms", "cut_ms", "hash_ms"]

RUN_HEADER = ["frame max, ms CPU", "p95", "last", "physics, all nodes", "protocol", "transport",
              "protocol + transport / physics", "projecting", "handed over", "back", "largest cluster", "hosted",
              "late", "violations"]


def runs_table(runs, first_header, first_cells):
    return table(first_header + RUN_HEADER, [run_row(r, *first_cells(r)) for r in runs]) if runs else "Not run.\n\n"


def requirement(name, found, bound, met):
    return [name, found, bound, "met" if met else "**not met**"]


def speed_up_of(summary, series, aura, nodes):
    found = [r for r in summary["speed_up"] if (r["series"], r["aura"], r["nodes"]) == (series, aura, nodes)]
    return found[0] if found else None


def spread(text, values, unit=""):
    return f"{text} ({min(values):.1f}{unit} to {max(values):.1f}{unit})" if len(values) > 1 else text


def of_repeats(r):
    """The median of the ratio of the largest frames, and its least and most."""
    frame = r["frame_max"]
    return spread(f"{frame['median']:.2f}", [frame["least"], frame["most"]] if r["repeats"] > 1 else [])


def windows(folder, run):
    """Of all nodes together, in order of time."""
    with open(folder / run["windows"], newline="") as file:
        return [w for w in csv.DictReader(file) if w["region"] == "-1"]


def bodies_in_real_time(folder, summary, nodes):
    """Of each run on so many nodes: up to how many bodies the mean frame of every 5 s so far was within a step."""
    counts = []
    for run in of(summary["runs"], "columns", nodes=nodes):
        held = [0]
        for w in windows(folder, run):
            if float(w["frame_mean_ms"]) > STEP_MS:
                break
            held.append(int(w["bodies"]))
        counts.append(held[-1])
    return counts


def real_time_rows(directory, walls):
    rows = []
    for k, wall in walls.items():
        one, two = (bodies_in_real_time(directory / WALLS[k], wall, nodes) for nodes in (1, 2))
        found = f"{statistics.median(two):.0f} ({min(two)} to {max(two)})" if len(two) > 1 else f"{two[0]}"
        most = max(r["bodies"] for r in of(wall["runs"], "columns"))
        rows.append(requirement(f"bodies in real time, 2 nodes, wall clock over DDS, columns, K = {k}", found,
                                f"more than one node's {max(one)}", min(two) > max(one)))
        rows.append(requirement(f"the same to the end of the rain, K = {k}", found, f"{most}", min(two) >= most))
    return rows


def requirements(summaries, sizes, walls, directory):
    """`summaries`, `walls`: by K."""
    rows = []
    for k, summary in summaries.items():
        for nodes, wanted in WANTED.items():
            r = speed_up_of(summary, "columns", "swept", nodes)
            if r:
                rows.append(requirement(f"max frame, {nodes} nodes against 1, by CPU time, columns, swept, K = {k} "
                                        f"(thesis {THESIS[nodes]})", of_repeats(r), f"at least {wanted}",
                                        r["frame_max"]["median"] >= wanted))
    for k, wall in walls.items():
        r = speed_up_of(wall, "columns", "swept", 2)
        if r:
            rows.append(requirement(f"max frame, 2 nodes against 1, wall clock over DDS, columns, K = {k}",
                                    of_repeats(r), "at least 3", r["frame_max"]["median"] >= 3))
    rows += real_time_rows(directory, walls)
    for k, summary in summaries.items():
        rains = of(summary["runs"], "columns", nodes=2, aura="swept")
        if rains:
            shares = sorted(100 * r["overhead_share"] for r in rains)
            found = statistics.median(shares)
            rows.append(requirement(f"protocol + transport / physics, 2 nodes of {rains[0]['bodies'] // 2} bodies, half "
                                    f"of them near the border, K = {k}", spread(f"{found:.1f}%", shares, "%"),
                                    "below 10%", found < 10))
    for aura, most in (("tight", 40), ("swept", 80)):
        found = sizes["aura_update"][aura]
        rows.append(requirement(f"bytes of an aura update, {aura}", f"{found:.0f}", f"at most {most}", found <= most))
    return table(["requirement", "found", "wanted", ""], rows)


def speed_up_table(summary):
    rows = []
    for r in sorted(summary["speed_up"], key=lambda r: (r["series"], r["nodes"], r["aura"])):
        rows.append([r["series"], r["nodes"], r["aura"], of_repeats(r),
                     f"{r['frame_p95']['median']:.2f}", f"{r['last_frame']['median']:.2f}",
                     f"{r['fitted']['median']:.2f}", r.get("thesis", "")])
    return table(["series", "nodes", "aura", "max frame", "p95", "last 5 s", "fitted coefficients", "thesis (fitted)"], rows)


def overhead_table(summary):
    """Thesis 5.1.3: what a boundary body costs more than one in the middle."""
    rows = []
    for series in ("cuts",):
        central = {r["repeat"]: r for r in of(summary["runs"], series, nodes=1)}
        for r in of(summary["runs"], series, aura="swept"):
            if r["nodes"] == 1 or r["repeat"] not in central or not r["projecting"]:
                continue
            sum_ms = sum(r[phase] for phase in PHASES)
            c = central[r["repeat"]]
            central_ms = sum(c[phase] for phase in PHASES)
            rows.append([r["nodes"], f"{sum_ms:.1f}", f"{central_ms:.1f}", r["projecting"],
                         f"{1e3 * (r['protocol_ms'] + r['transport_ms']) / r['projecting']:.1f}",
                         f"{1e3 * sum_ms / r['bodies']:.1f}"])
    return table(["nodes", "all nodes, ms CPU per step", "one node", "projecting",
                  "protocol and transport per projecting body, us", "cost per body, us"], rows)


def sizes_table(sizes):
    return table(["message", "bytes"],
                 [["aura batch with nothing in it", sizes["aura_batch"]]]
                 + [[f"each aura update, {k}", f"{v:.0f}"] for k, v in sizes["aura_update"].items()]
                 + [["each aura deleted", f"{sizes['aura_delete']:.0f}"], ["hand-off with nothing in it", sizes["hand_off"]],
                    ["each body handed over", f"{sizes['hand_off_body']:.0f}"],
                    ["each contact point handed over", f"{sizes['hand_off_contact_point']:.0f}"],
                    ["acknowledgement", sizes["ack"]]])


def traffic_row(r, *first):
    node_steps = r["nodes"] * r["steps"]
    return list(first) + [f"{r['link_bytes'] / node_steps:.0f}", f"{r['datagrams'] / node_steps:.2f}",
                          f"{r['aura_bytes'] / max(1, r['aura_updates']):.1f}",
                          f"{r['hand_off_bytes'] / max(1, r['hand_offs']):.0f}", r["hand_offs"],
                          f"{r['slow_down']:.2f}", r["late"], r["violations"]]


def traffic_table(runs, first_header, first_cells):
    header = first_header + ["bytes per node and step", "datagrams of 1,300 bytes", "bytes per aura message, batch and all",
                             "bytes per body handed over", "handed over", "time taken / simulated", "late", "violations"]
    return table(header, [traffic_row(r, *first_cells(r)) for r in runs])


def bandwidth(directory):
    summary = json.loads((directory / "summary.json").read_text())
    sizes = json.loads((directory / "sizes.json").read_text())
    text = "## Bandwidth\n\nPayloads of RTPS DATA, as Fast CDR writes them; RTPS, UDP and IP add about 100 bytes for each "
    text += "datagram. Two columns, everything falls near their border, 160 bodies a second for "
    text += f"{summary['runs'][0]['steps'] / 60:g} s.\n\n"
    text += sizes_table(sizes)
    text += "### By speed\n\n"
    text += traffic_table(sorted(of(summary["runs"], "speed"), key=lambda r: (r["fall_m_s"], r["aura"])),
                          ["speed at birth, m/s per axis", "aura"], lambda r: (f"{r['fall_m_s']:g}", r["aura"]))
    text += "### As the link shrinks\n\nVirtual time, `bounded`: nodes wait for what a narrow link has not brought yet, "
    text += "so the world slows down and nothing is late.\n\n"
    text += traffic_table(sorted(of(summary["runs"], "link"), key=lambda r: (-r["bandwidth_B_s"], r["aura"])),
                          ["link of each node, kB/s", "aura"], lambda r: (f"{r['bandwidth_B_s'] / 1e3:g}", r["aura"]))
    return sizes, text


def frames_by_bodies(folder, summary, nodes):
    """Largest frame of each 5 s by the number of bodies then, of the first run on so many nodes."""
    run = of(summary["runs"], "columns", nodes=nodes)[0]
    return {int(w["bodies"]): float(w["frame_max_ms"]) for w in windows(folder, run)}


def over_time_table(directory, walls):
    one = frames_by_bodies(directory / WALLS[2], walls[2], 1)
    two = {k: frames_by_bodies(directory / WALLS[k], wall, 2) for k, wall in walls.items()}
    # Bodies under way between two nodes are on neither, so a window of two nodes may have a few less.
    rows = []
    for i, (bodies, frame) in enumerate(one.items()):
        frames = [list(two[k].values())[i] for k in walls]
        rows.append([bodies, f"{frame:.1f}"] + [f"{f:.1f} ({frame / f:.2f})" for f in frames])
    return table(["bodies", "one node"] + [f"two nodes, K = {k} (times less)" for k in walls], rows)


def by_lookahead(directory, folders):
    files = {k: directory / folder / "summary.json" for k, folder in folders.items()}
    return {k: json.loads(file.read_text()) for k, file in files.items() if file.exists()}


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("directory", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("docs"))
    parser.add_argument("--note", default="", help="what a reader has to know of these runs")
    arguments = parser.parse_args()
    directory = arguments.directory
    summaries = by_lookahead(directory, {2: "long", 1: "long_k1"})
    walls = by_lookahead(directory, WALLS)
    summary = summaries[2]
    short = json.loads((directory / "short" / "summary.json").read_text())
    runs = short["runs"]
    sizes, bandwidth_text = bandwidth(directory / "bandwidth")

    text = INTRODUCTION.format(measured=measured_line(directory), machine=machine_line(),
                               repeats=1 + max(r["repeat"] for r in summaries[1]["runs"]))
    text += f"**{arguments.note}**\n\n" if arguments.note else ""
    text += "## What has to hold, and what was found\n\n" + requirements(summaries, sizes, walls, directory)
    text += "## Speed-up\n\nOne node's frame over the slowest node's. The thesis's numbers are ratios of fitted "
    text += "coefficients (log10 of the frame time over bodies).\n\n"
    for k, of_k in summaries.items():
        text += f"K = {k}:\n\n" + speed_up_table(of_k)
    text += "In *cuts* the bodies are the same, so as many times less as there are nodes is what can be had.\n\n"
    text += "The first 20 s, 3,200 bodies, with every aura:\n\n" + speed_up_table(short)
    text += "## Columns: the rain follows the regions\n\nTimes other than frames are sums over the nodes, means of the last "
    text += "5 s; late collisions of one node are those that one world has, too.\n\n"
    for k, all_runs in [(k, of_k["runs"]) for k, of_k in summaries.items()] + [(2, runs)]:
        text += f"K = {k}:\n\n"
        text += runs_table(of(all_runs, "columns"), ["bodies", "nodes", "aura"],
                           lambda r: (r["bodies"], r["nodes"], r["aura"]))
    text += "## Cuts: one world of 8 columns\n\n"
    for all_runs in (summary["runs"], runs):
        text += runs_table(of(all_runs, "cuts"), ["bodies", "nodes", "aura"],
                           lambda r: (r["bodies"], r["nodes"], r["aura"]))
    text += "### What a boundary costs (thesis 5.1.3)\n\n" + overhead_table(summary)
    text += "## Corners\n\n" + runs_table(of(runs, "corners"), ["regions"], lambda r: (r["regions"],))
    text += "## Weak scaling: 20 bodies a second and node\n\n"
    text += runs_table(of(runs, "weak"), ["nodes", "bodies"], lambda r: (r["nodes"], r["bodies"]))
    text += "## Share of the bodies that fall near the border, 2 nodes\n\n"
    text += runs_table(sorted(of(runs, "border"), key=lambda r: r["border_share"]), ["share"],
                       lambda r: (f"{100 * r['border_share']:g}%",))
    text += "## Asleep\n\nThe rain stops half way; in the last 5 s some sleep.\n\n"
    text += runs_table(of(runs, "asleep"), ["bodies", "awake"], lambda r: (r["bodies"], r["awake"]))
    text += "## U: how far a body may leave its path, 4 nodes\n\nWhat hits can do is stated over U "
    text += "(docs/decisions/0015), so between 0.1 and 1 only the room of slow bodies changes; above 1 all have more.\n\n"
    text += runs_table(sorted(of(runs, "uncertainty"), key=lambda r: r["uncertainty"]), ["U"],
                       lambda r: (f"{r['uncertainty']:g}",))
    text += "## K: how far nodes may be apart, 4 nodes\n\n"
    text += runs_table(sorted(of(runs, "lookahead"), key=lambda r: r["lookahead"]), ["K"], lambda r: (r["lookahead"],))
    if walls:
        text += "## Real nodes over DDS, wall clock\n\nms are of the wall clock here. The largest frame of each 5 s, "
        text += "ms, of the first run of each kind:\n\n" + over_time_table(directory, walls)
    for k, wall in walls.items():
        text += f"K = {k}:\n\n"
        unknown = {"returns": None, "late": "-"}  # what reports of processes do not say in windows
        text += runs_table([r | unknown for r in of(wall["runs"], "columns")], ["bodies", "nodes", "time taken / simulated"],
                           lambda r: (r["bodies"], r["nodes"], f"{r['slow_down']:.2f}"))
    text += bandwidth_text
    text += "## Figures\n\n"
    (arguments.out / "scalability").mkdir(parents=True, exist_ok=True)
    for length, name in FIGURES:
        figure = directory / length / "figures" / f"{name}.png"
        if figure.exists():
            shutil.copy(figure, arguments.out / "scalability" / f"{name}.png")
            text += f"![{name}](scalability/{name}.png)\n\n"
    (arguments.out / "scalability.md").write_text(text.rstrip("\n") + "\n")


if __name__ == "__main__":
    main()
