#!/usr/bin/env python3
"""Kills nodes of real runs at random and compares what comes of them with the run that nobody disturbed.

Each run has its own seed, which decides when which node is killed (SIGKILL), and what else happens meanwhile: orders with
a state of their own, new regions, a drain, another death within the recovery. Writes DIR/runs.jsonl, a line for each run,
and goes on where it was stopped. The sums are stored as the suite recovery. Fails where a run is not as the undisturbed
one. Everything stays on loopback, in the DDS domain that is given.
"""
import argparse
import json
import os
import pathlib
import random
import re
import signal
import subprocess
import tempfile
import threading
import time

from stored_rows import Rows, percentile

REGIONS = 4
HALVES = ["-40 -40 {x} 0", "{x} -40 40 0", "-40 0 {x} 40", "{x} 0 40 40"]


class Run:
    """One launch, its lines as they come, and its nodes' process ids."""

    def __init__(self, program, words, log):
        self.lines = []
        self.log = open(log, "w")
        self.process = subprocess.Popen([program, "launch", *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                        text=True, start_new_session=True)
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()

    def _read(self):
        for line in self.process.stdout:
            self.lines.append((time.monotonic(), line.rstrip()))
            self.log.write(line)
            self.log.flush()

    def pid_of(self, region):
        for entry in pathlib.Path("/proc").iterdir():
            if not entry.name.isdigit():
                continue
            try:
                if f"PPid:\t{self.process.pid}\n" not in (entry / "status").read_text():
                    continue
                words = (entry / "cmdline").read_bytes().decode().split("\0")
            except OSError:
                continue
            if "--region" in words and words[words.index("--region") + 1] == str(region):
                return int(entry.name)
        return None

    def kill(self, region):
        pid = self.pid_of(region)
        if pid is not None:
            os.kill(pid, signal.SIGKILL)
        return pid is not None

    def count(self, text, since=0.0):
        return sum(text in line for at, line in self.lines if at >= since)

    def times(self, text, since):
        return [at for at, line in self.lines if at >= since and text in line]

    def running(self):
        return self.process.poll() is None

    def wait(self, seconds):
        try:
            self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, signal.SIGTERM)
            self.process.wait(60)
            self.lines.append((time.monotonic(), "recovery.py: it did not come to its end"))
        self.reader.join(10)


def hashes(report):
    path = pathlib.Path(report) / "state_hash.csv"
    return path.read_text() if path.exists() else ""


class Case:
    def __init__(self, options, seed, kind):
        self.options, self.seed, self.kind = options, seed, kind
        self.random = random.Random(f"{seed} {kind}")
        self.file = f"launch_configs/{options.scene}.yaml"
        self.own = ["--set", f"dds.domain={options.domain}", "--set", "time.sync=deterministic"]

    def launch(self, folder, name, more):
        words = [self.file, "--headless", "--steps", str(self.options.steps), "--report", f"{folder}/{name}", "--saves",
                 f"{folder}/saves", *self.own, *more]
        return Run(self.options.program, words, f"{folder}/{name}.log")

    def orders(self):
        """In states that both runs come to, with time to arrive: a push and a new body, now and then."""
        made = []
        for state in range(700, self.options.steps - 60, 150):
            at = state + self.random.randrange(60)
            if self.random.random() < 0.5:
                made.append((at, ["spawn", "--radius", "0.4", "--p", *self.place(), "--at", str(at)]))
            else:
                made.append((at, ["impulse", "--body", str(self.random.randrange(90)), "--J", "0", "0", "30", "--at",
                                  str(at)]))
        return made

    def place(self):
        return [f"{self.random.uniform(-15, 15):.2f}", f"{self.random.uniform(-15, 15):.2f}", "12"]

    def send(self, words):
        return subprocess.Popen([self.options.program, "send", words[0], self.file, *words[1:], *self.own],
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def give(self, run, orders, state_now):
        """Orders whose state comes within ten seconds; one after the other, so that they have the same numbers."""
        replies = []
        while orders and orders[0][0] < state_now + 600 and run.running():
            at, words = orders.pop(0)
            told = self.send(words)
            out, _ = told.communicate(timeout=90)
            said = out.strip().splitlines()[-1] if out.strip() else ""
            is_late = told.returncode == 0 and json.loads(said).get("step") != at
            replies.append((1 if is_late else told.returncode, f"for state {at}, too late: {said}" if is_late else said))
        return replies

    def go(self):
        with tempfile.TemporaryDirectory() as folder:
            plan = self.orders()
            result = {"seed": self.seed, "kind": self.kind, "deaths": [], "orders": len(plan), "refused": [],
                      "drains": 0}
            calm = self.launch(folder, "calm", [])
            self.play(calm, list(plan), result, False, folder)
            run = self.launch(folder, "run", [])
            self.play(run, list(plan), result, True, folder)
            wanted, found = hashes(f"{folder}/calm"), hashes(f"{folder}/run")
            summary = pathlib.Path(f"{folder}/run/summary.json")
            told = json.loads(summary.read_text()) if summary.exists() else {}
            result["equal"] = bool(wanted) and wanted == found
            result["exit"] = run.process.returncode
            for key in ("bodies_lost", "bodies_duplicated", "steps", "real_time_factor"):
                result[key] = told.get(key)
            result["spawned"] = told.get("bodies_spawned")
            result["again"] = run.count("once more")
            if not result["equal"] or result["exit"] != 0:
                keep = pathlib.Path(self.options.out) / f"failed_{self.kind}_{self.seed}"
                subprocess.run(["rm", "-rf", str(keep)], check=False)
                subprocess.run(["cp", "-r", folder, str(keep)], check=False)
            return result

    def state_of(self, folder, name):
        """The last state that a node has on disk; it grows by a second's states at a time."""
        best = 0
        for path in pathlib.Path(folder).glob(f"{name}/region_*/steps.csv"):
            rows = path.read_bytes().splitlines()
            if len(rows) > 1:
                best = max(best, int(rows[-1].split(b",")[1]))
        return best

    def play(self, run, orders, result, disturb, folder):
        name = "run" if disturb else "calm"
        deadline = time.monotonic() + self.options.patience
        while run.running() and self.state_of(folder, name) < 60 and time.monotonic() < deadline:
            time.sleep(0.05)
        next_death = time.monotonic() + self.random.uniform(0.5, 2.5)
        while run.running() and time.monotonic() < deadline:
            state = self.state_of(folder, name)
            result["refused"] += [reply for code, reply in self.give(run, orders, state) if code != 0]
            if disturb and time.monotonic() > next_death and state + 180 < self.options.steps:
                self.disturb(run, result)
                next_death = time.monotonic() + self.random.uniform(1.0, 4.0)
            time.sleep(0.02)
        run.wait(max(1.0, deadline - time.monotonic()))

    def disturb(self, run, result):
        """One death, or two at once or shortly after each other; sometimes while something else is under way."""
        beside = None
        what = self.random.random()
        if what < 0.15:
            x = self.random.uniform(-6, 6)
            beside = self.send(["regions", "--boxes", *" ".join(HALVES).format(x=f"{x:.2f}").split()])
        elif what < 0.3:
            result["drains"] += 1
            beside = self.send(["drain", str(self.random.randrange(REGIONS))])
        if beside is not None:
            time.sleep(self.random.uniform(0.0, 1.0))
        first = self.random.randrange(REGIONS)
        regions = [first]
        if self.kind == "pairs":
            regions.append((first + 2) % REGIONS)  # neither keeps the other's parts
        elif self.random.random() < 0.2:
            regions.append((first + self.random.choice([1, 2, 3])) % REGIONS)
        begin = time.monotonic()
        killed = []
        for region in regions:
            if run.kill(region):
                killed.append(region)
            if self.kind != "pairs" and len(regions) > 1:
                time.sleep(self.random.uniform(0.0, 0.8))
        # The last of them is back when every node has gone back after it.
        while run.running() and time.monotonic() < begin + 30:
            back = run.times("went back to state", begin)
            if len(back) >= REGIONS and time.monotonic() > back[-1] + 0.5:
                break
            time.sleep(0.02)
        back = run.times("went back to state", begin)
        states = [int(re.search(r"went back to state (\d+)", line).group(1)) for at, line in run.lines
                  if at >= begin and "went back to state" in line]
        result["deaths"].append({"regions": killed, "beside": what < 0.3,
                                 "s": round(back[-1] - begin, 3) if len(back) >= REGIONS else None,
                                 "state": states[-1] if states else None})
        if beside is not None:
            try:
                out, _ = beside.communicate(timeout=60)
                if beside.returncode != 0:
                    result["refused"].append(f"{beside.args[2]}: {out.strip().splitlines()[-1] if out.strip() else ''}")
            except subprocess.TimeoutExpired:
                beside.kill()
                result["refused"].append(f"{beside.args[2]}: no answer")


def store(runs):
    rows = Rows()
    for kind, name in (("single", "one, or two shortly after each other"), ("pairs", "two at once")):
        some = [run for run in runs if run["kind"] == kind]
        deaths = [death for run in some for death in run["deaths"]]
        times = [death["s"] for death in deaths if death["s"] is not None]
        for metric, value in (("runs", len(some)), ("deaths", len(deaths)),
                              ("nodes killed", sum(len(death["regions"]) for death in deaths)),
                              ("orders", sum(run["orders"] for run in some)), ("drains", sum(run["drains"] for run in some)),
                              ("from state 0", sum(death["state"] == 0 for death in deaths)),
                              ("runs with other bits", sum(not run["equal"] for run in some))):
            rows.add(f"deaths/{name}", metric, value)
        for share, metric in ((0.5, "back p50"), (0.95, "back p95"), (1, "back max")):
            rows.add(f"deaths/{name}", metric, percentile(times, share), "s")
    rows.store("recovery")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default="build/release/aurasim")
    parser.add_argument("--scene", default="demo")
    parser.add_argument("--steps", type=int, default=1500)
    parser.add_argument("--deaths", type=int, default=100, help="of kind single, at least")
    parser.add_argument("--pairs", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1, help="the first")
    parser.add_argument("--domain", type=int, default=73)
    parser.add_argument("--patience", type=float, default=180, help="seconds of a run")
    parser.add_argument("--out", default="build/recovery")
    options = parser.parse_args()
    out = pathlib.Path(options.out)
    out.mkdir(parents=True, exist_ok=True)
    rows = out / "runs.jsonl"
    done = [json.loads(line) for line in rows.read_text().splitlines()] if rows.exists() else []
    for kind, wanted in (("single", options.deaths), ("pairs", options.pairs)):
        seed = options.seed
        while sum(len(r["deaths"]) for r in done if r["kind"] == kind) < wanted:
            if not any(r["seed"] == seed and r["kind"] == kind for r in done):
                result = Case(options, seed, kind).go()
                done.append(result)
                with rows.open("a") as file:
                    file.write(json.dumps(result) + "\n")
                print(json.dumps(result), flush=True)
            seed += 1
    bad = [r for r in done if not r["equal"] or r["exit"] != 0 or r["refused"]]
    store(done)
    print(f"{len(done)} runs, {sum(len(r['deaths']) for r in done)} deaths or pairs, {len(bad)} runs not as undisturbed")
    return 1 if bad else 0


if __name__ == "__main__":
    raise SystemExit(main())
