#!/usr/bin/env python3
"""Runs whose nodes are changed one after the other (a rolling restart), and long ones whose nodes are killed, drained and
saved at random, with the memory that they take. Both are compared with the run that nobody disturbed.

Writes DIR/rolling.jsonl and, with --soak, DIR/soak.jsonl, a line for each run, and the medians as the suite
recovery.
"""
import argparse
import json
import pathlib
import random
import re
import tempfile
import time

from recovery import REGIONS, Case, hashes
from stored_rows import Rows

WENT_BACK = re.compile(r"region (\d+) went back to state (\d+) after ([0-9.]+) s")


def summary_of(folder):
    path = pathlib.Path(f"{folder}/run/summary.json")
    return json.loads(path.read_text()) if path.exists() else {}


def stood_s(run, since):
    """How long the nodes that were there before stood: whoever took over has waited longer, and nobody for it."""
    times = {}
    for at, line in run.lines:
        found = WENT_BACK.search(line)
        if found and at >= since:
            times[found.group(1)] = float(found.group(3))
    return times


def wait_for_state(case, run, folder, state, seconds):
    deadline = time.monotonic() + seconds
    while run.running() and case.state_of(folder, "run") < state and time.monotonic() < deadline:
        time.sleep(0.05)


def undisturbed(case, folder):
    """One node, unpaced: the same bits."""
    run = case.launch(folder, "calm", ["--set", "regions.count=1", "--set", "time.pace=none"])
    run.wait(3600)
    return hashes(f"{folder}/calm")


def result_of(case, run, folder, more):
    told = summary_of(folder)
    wanted = undisturbed(case, folder)
    return {"equal": bool(wanted) and wanted == hashes(f"{folder}/run"), "exit": run.process.returncode,
            "steps": case.options.steps, "bodies_lost": told.get("bodies_lost"),
            "bodies_duplicated": told.get("bodies_duplicated"), "real_time_factor": told.get("real_time_factor"), **more}


def rolling_restart(options):
    """Every node in turn gives its region to a new process, while the world goes on."""
    case = Case(options, options.seed, "rolling")
    with tempfile.TemporaryDirectory() as folder:
        run = case.launch(folder, "run", [])
        drains = []
        for region in range(REGIONS):
            wait_for_state(case, run, folder, (region + 1) * options.steps // (REGIONS + 2), 120)
            begin = time.monotonic()
            told = case.send(["drain", str(region)])
            out, _ = told.communicate(timeout=90)
            stood = stood_s(run, begin)
            stood.pop(str(region), None)
            drains.append({"region": region, "ok": told.returncode == 0, "s": round(time.monotonic() - begin, 2),
                           "stood_s": max(stood.values(), default=None), "said": out.strip()})
        run.wait(options.steps / 60 + 300)
        return result_of(case, run, folder, {"drains": drains})


def resident_kB(run):
    sizes = {}
    for region in range(REGIONS):
        pid = run.pid_of(region)
        try:
            status = pathlib.Path(f"/proc/{pid}/status").read_text()
        except OSError:
            continue
        found = re.search(r"VmRSS:\s+(\d+) kB", status)
        if found:
            sizes[region] = int(found.group(1))
    return sizes


def soak(options):
    """Kills, drains and saves at random, all the time; how large the launcher and the nodes are every ten seconds."""
    options.steps = int(options.soak * 60 * 60)
    case = Case(options, options.seed, "soak")
    dice = random.Random(f"soak {options.seed}")
    counts = {"kills": 0, "drains": 0, "saves": 0, "refused": 0}
    sizes = []
    with tempfile.TemporaryDirectory() as folder:
        run = case.launch(folder, "run", [])
        wait_for_state(case, run, folder, 60, 60)
        began = time.monotonic()
        next_look = next_act = began + 5
        while run.running() and time.monotonic() < began + options.soak * 60 + 600:
            now = time.monotonic()
            if now > next_look:
                sizes.append([round(now - began), case.state_of(folder, "run"), max(resident_kB(run).values(), default=0),
                              int(re.search(r"VmRSS:\s+(\d+)",
                                            pathlib.Path(f"/proc/{run.process.pid}/status").read_text()).group(1))])
                next_look = now + 10
            if now > next_act and case.state_of(folder, "run") + 300 < options.steps:
                act(case, run, dice, counts)
                next_act = time.monotonic() + dice.uniform(2, 12)
            time.sleep(0.1)
        run.wait(300)
        return result_of(case, run, folder, {"counts": counts, "sizes": sizes, "minutes": options.soak})


def act(case, run, dice, counts):
    what = dice.choice(["kills", "kills", "drains", "saves"])
    counts[what] += 1
    if what == "kills":
        run.kill(dice.randrange(REGIONS))
        return
    if what == "drains":
        told = case.send(["drain", str(dice.randrange(REGIONS))])
    else:
        told = case.send(["save", f"world-{counts['saves'] % 3}.cut"])
    try:
        told.communicate(timeout=60)
    except Exception:  # it is not the client that is measured
        told.kill()
    counts["refused"] += told.returncode != 0


def add(rows, kind, run):
    if kind == "rolling":
        rows.add("rolling/drains", "stood", max((d["stood_s"] for d in run["drains"] if d["stood_s"] is not None), default=None), "s")
        rows.add("rolling/drains", "real-time factor", run["real_time_factor"])
        return
    for name, value in (("minutes", run["minutes"]), ("states", run["steps"]), *run["counts"].items()):
        rows.add("long run/all", name, value)
    for share, name in ((0.1, "a tenth"), (0.5, "half"), (1, "all")):
        of_node, of_launcher = run["sizes"][min(len(run["sizes"]) - 1, int(share * len(run["sizes"])))][2:4]
        rows.add(f"long run memory/{name} of the time", "largest node", of_node / 1024, "MiB")
        rows.add(f"long run memory/{name} of the time", "launcher", of_launcher / 1024, "MiB")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default="build/release/aurasim")
    parser.add_argument("--scene", default="demo")
    parser.add_argument("--steps", type=int, default=3600, help="of a rolling restart")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--soak", type=float, default=0, help="minutes")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--domain", type=int, default=73)
    parser.add_argument("--out", default="build/recovery")
    options = parser.parse_args()
    out = pathlib.Path(options.out)
    out.mkdir(parents=True, exist_ok=True)
    good, rows = True, Rows()
    kinds = [("soak", soak)] if options.soak else [("rolling", rolling_restart)] * options.repeats
    with (out / f"{kinds[0][0]}.jsonl").open("w") as file:
        for _, make in kinds:
            row = make(options)
            good = good and row["equal"] and row["exit"] == 0 and row["bodies_lost"] == 0
            file.write(json.dumps(row) + "\n")
            print(json.dumps(row), flush=True)
            add(rows, kinds[0][0], row)
    rows.store("recovery")
    return 0 if good else 1


if __name__ == "__main__":
    raise SystemExit(main())
