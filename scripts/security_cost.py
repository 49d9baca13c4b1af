#!/usr/bin/env python3
"""What keys cost: the demo open and with a store of keys made for it (`launch --secure`), by turns, and open beside an
overseer that is left alone, with idle processors and busy ones, or attacked. Writes DIR/runs.jsonl, and the medians as
the suite security_cost. About 15 minutes on 2 cores, where nothing else runs. Fails where a run lost bodies or bits."""
import argparse
import contextlib
import ctypes
import hashlib
import json
import os
import pathlib
import platform
import resource
import socket
import statistics
import struct
import subprocess
import sys
import tempfile
import time

from recovery import REGIONS, Case, hashes
from stored_rows import Rows, build

KINDS = {"open": [], "keys": ["--secure"]}
OVERSEERS = ("left alone", "left alone, busy", "attacked")

PAGE_NICENESS, PAGE_SLICE_NS = 10, 100_000  # src/overseer/give_way.cpp
SCHED_SETATTR = {"x86_64": 314, "aarch64": 274}[platform.machine()]


def seconds_of_children():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def middle(summary, name, part):
    return statistics.median(region[name][part] for region in summary["regions"])


def one_state(options, words):
    case = Case(argparse.Namespace(**{**vars(options), "steps": 1}), 1, "one state")
    with tempfile.TemporaryDirectory() as folder:
        begin = time.monotonic()
        run = case.launch(folder, "run", words)
        run.wait(120)
        if run.process.returncode != 0:
            raise RuntimeError("the run of one state failed: " + "; ".join(line for _, line in run.lines))
        return round(time.monotonic() - begin, 3)


@contextlib.contextmanager
def process(words, **options):
    child = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, **options)
    try:
        yield child
    finally:
        child.terminate()
        child.wait(60)


def wait_for_port(port):
    deadline = time.monotonic() + 60
    while time.monotonic() < deadline:
        with socket.socket() as caller:
            if caller.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.05)
    raise RuntimeError("the overseer does not listen")


def only_on_idle_processors():
    os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))


def as_threads_for_pages():
    """sched_setattr(2): size, policy, flags, nice, priority, runtime, deadline, period."""
    attributes = struct.pack("=IIQiIQQQ", 48, 0, 0, PAGE_NICENESS, 0, PAGE_SLICE_NS, 0, 0)
    if ctypes.CDLL(None, use_errno=True).syscall(SCHED_SETATTR, 0, attributes, 0) != 0:
        raise OSError(ctypes.get_errno(), "sched_setattr")


def computes_without_end(preexec_fn):
    return process([sys.executable, "-c", "while True: pass"], preexec_fn=preexec_fn)


@contextlib.contextmanager
def beside_overseer(kind, port):
    with contextlib.ExitStack() as stack:
        if kind == "attacked":
            attack = ["node", "tests/web/attack.mjs", f"http://127.0.0.1:{port}/", "--seconds", "600"]
            stack.enter_context(process(attack, preexec_fn=only_on_idle_processors))
        if kind == "left alone, busy":
            for scheduling in (as_threads_for_pages, only_on_idle_processors):
                stack.enter_context(computes_without_end(scheduling))
        yield


@contextlib.contextmanager
def overseer(case, kind):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with process([case.options.program, "overseer", case.file, "--port", str(port), *case.own]) as served:
        wait_for_port(port)
        with beside_overseer(kind, port):
            yield
            if served.poll() is not None:
                raise RuntimeError(f"the overseer has ended with {served.returncode}")


def whole_run(case, words, beside=contextlib.nullcontext):
    with tempfile.TemporaryDirectory() as folder:
        cpu = seconds_of_children()
        with beside():
            run = case.launch(folder, "run", words)
            run.wait(case.options.steps / 60 + 120)
        summary = json.loads(pathlib.Path(f"{folder}/run/summary.json").read_text())
        row = {"cpu_s": round(seconds_of_children() - cpu, 2), "exit": run.process.returncode,
               "hashes": hashlib.sha256(hashes(f"{folder}/run").encode()).hexdigest()}
        for key in ("real_time_factor", "migrations", "bodies_lost"):
            row[key] = summary[key]
        for name in ("frame_ms", "wait_ms", "transport_ms"):
            row[name] = {part: middle(summary, name, part) for part in ("p50", "p99")}
        return row


def back_s(case, words):
    """None: it was not back within a minute."""
    with tempfile.TemporaryDirectory() as folder:
        run = case.launch(folder, "run", words)
        while run.running() and case.state_of(folder, "run") < 240:
            time.sleep(0.05)
        killed = time.monotonic()
        run.kill(2)
        while run.running() and len(run.times("went back to state", killed)) < REGIONS and time.monotonic() < killed + 60:
            time.sleep(0.01)
        back = run.times("went back to state", killed)
        run.wait(case.options.steps / 60 + 120)
        return round(back[-1] - killed, 3) if len(back) >= REGIONS else None


def measure(options):
    case = Case(options, 1, "keys")
    with (options.out / "runs.jsonl").open("w") as file:
        def keep(row):
            file.write(json.dumps(row) + "\n")
            print(json.dumps(row), flush=True)

        for repeat in range(options.repeats):
            for kind, words in KINDS.items():
                keep({"kind": kind, "repeat": repeat, "one_state_s": one_state(options, words), **whole_run(case, words),
                      "launcher_s": back_s(case, words), "spare_s": back_s(case, [*words, "--spares", "1"])})
            for kind in OVERSEERS:
                keep({"kind": kind, "repeat": repeat,
                      **whole_run(case, [], lambda: overseer(case, kind))})


FRAME = (("real-time factor", "real_time_factor", "1"), ("frame p50", "frame_ms.p50", "ms"), ("frame p99", "frame_ms.p99", "ms"))
WANTED = (("one state", "one_state_s", "s"), ("CPU", "cpu_s", "s"), *FRAME, ("sending p50", "transport_ms.p50", "ms"),
          ("sending p99", "transport_ms.p99", "ms"), ("waiting p50", "wait_ms.p50", "ms"), ("waiting p99", "wait_ms.p99", "ms"),
          ("hand-offs", "migrations", "1"), ("back by the launcher", "launcher_s", "s"), ("back by a spare", "spare_s", "s"))


def store(options):
    """False if a run has other bits than the others, has lost bodies or ended badly."""
    runs = [json.loads(line) for line in (options.out / "runs.jsonl").read_text().splitlines()]
    rows = Rows()
    for run in runs:
        group, wanted = ("keys", WANTED) if run["kind"] in KINDS else ("overseer", FRAME)
        for name, path, unit in wanted:
            key, _, part = path.partition(".")
            rows.add(f"{group}/{run['kind']}", name, run[key][part] if part else run[key], unit)
    rows.store("security_cost")
    return len({run["hashes"] for run in runs}) == 1 and not any(run["bodies_lost"] or run["exit"] for run in runs)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default="build/release/aurasim")
    parser.add_argument("--scene", default="demo")
    parser.add_argument("--steps", type=int, default=900)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--domain", type=int, default=74)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/security_cost"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    build()
    measure(options)
    return 0 if store(options) else 1


if __name__ == "__main__":
    raise SystemExit(main())
