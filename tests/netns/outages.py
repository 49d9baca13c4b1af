#!/usr/bin/env python3
"""Outages of a network of four hosts, in namespaces: afterwards there is one world, from a state that was kept.

  outages.py KIND LENGTH [KIND LENGTH ...] [--table FILE] [--set KEY=VALUE ...]

KIND: all (every link), halves01, halves02, halves03 (the two hosts named on one side), link (one host's), deaf (one
host hears nobody), mute (nobody hears one host), flap (every link, 1 s on and 1 s off). LENGTH: seconds.
Each outage is a run of its own, `deterministic`, on four nodes that are paced by the wall clock. It begins 4 s after the
first record. Checked: all nodes compute 5 s beyond the healing and end well, no body is lost or doubled, every state has
the bits of one undisturbed node, and the run has never gone back to its first state. All must compute again within 10 s
of the healing; a busy machine (AURASIM_PATIENCE, a factor) is given longer.
Exit code 77: this machine cannot make the laboratory. Domains 186, 187.
"""
import argparse
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
LAB = ROOT / "scripts/netns_lab.sh"
LAUNCH = "launch_configs/corner_stacks.yaml"
HOSTS = range(4)
BEFORE_S = 4.0
AFTER_S = 5.0
WITHIN_S = 10.0 * float(os.environ.get("AURASIM_PATIENCE", "1"))
AURASIM = os.environ.get("AURASIM", str(ROOT / "build/release/aurasim"))
NAME = os.environ.setdefault("AURASIM_LAB", f"auraout{os.getpid()}")


def lab(*words):
    subprocess.run([str(LAB), *map(str, words)], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)


def address(host):
    said = subprocess.run([str(LAB), "status"], check=True, capture_output=True, text=True).stdout
    return re.search(rf"^host {host}: ([0-9.]+),", said, re.M).group(1)


class Network:
    """Who hears whom: drops what comes to a host from others, where it comes in."""

    def __init__(self):
        self.addresses = [address(host) for host in HOSTS]

    def drop(self, host, sources):
        listed = ", ".join(self.addresses[s] for s in sources)
        rules = (f"table inet auraout {{ chain input {{ type filter hook input priority 0; "
                 f"ip saddr {{ {listed} }} meta l4proto udp drop; }}; }}")
        lab("on", host, "nft", rules)

    def accept(self, host):
        lab("on", host, "nft", "delete table inet auraout")

    def begin(self, kind):
        if kind in ("all", "flap"):
            for host in HOSTS:
                lab("cut", host)
        elif kind.startswith("halves"):
            side = {int(digit) for digit in kind[len("halves"):]}
            for host in HOSTS:
                self.drop(host, [other for other in HOSTS if (other in side) != (host in side)])
        elif kind == "link":
            lab("cut", 2)
        elif kind == "deaf":
            self.drop(2, [other for other in HOSTS if other != 2])
        elif kind == "mute":
            for host in HOSTS:
                if host != 2:
                    self.drop(host, [2])
        else:
            sys.exit(f"outages.py: '{kind}' is no kind of outage")

    def end(self, kind):
        if kind in ("all", "flap"):
            for host in HOSTS:
                lab("restore", host)
        elif kind == "link":
            lab("restore", 2)
        elif kind == "deaf":
            self.accept(2)
        else:
            for host in HOSTS:
                if kind != "mute" or host != 2:
                    self.accept(host)

    def outage(self, kind, length_s):
        end = time.monotonic() + length_s
        if kind != "flap":
            self.begin(kind)
            time.sleep(length_s)
            self.end(kind)
            return
        while time.monotonic() < end:
            self.begin(kind)
            time.sleep(1)
            self.end(kind)
            time.sleep(1)


class Node:
    def __init__(self, host, report, settings):
        self.host = host
        self.lines = []
        words = [str(LAB), "aurasim", host, "node", LAUNCH, "--region", host, "--or-spare", "--report", report,
                 "--set", "dds.domain=186", *settings]
        self.process = subprocess.Popen(list(map(str, words)), cwd=ROOT, stdout=subprocess.PIPE,
                                        stderr=subprocess.STDOUT, text=True, start_new_session=True)
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def read(self):
        for line in self.process.stdout:
            self.lines.append((time.monotonic(), line.rstrip()))

    def went_back(self):
        """(when, to which state), of each recovery."""
        found = [(at, re.search(r"went back to state (\d+)", line)) for at, line in list(self.lines)]
        return [(at, int(match.group(1))) for at, match in found if match]


def last_step(report, host):
    try:
        with open(report / f"region_{host}" / "steps.csv", "rb") as rows:
            rows.seek(max(0, os.fstat(rows.fileno()).st_size - 4096))
            last = rows.read().decode().strip().rsplit("\n", 1)[-1]
        return int(last.split(",", 2)[1])
    except (OSError, ValueError, IndexError):
        return -1


def wait_for(what, condition, patience_s):
    deadline = time.monotonic() + patience_s
    while not condition():
        if time.monotonic() > deadline:
            raise TimeoutError(f"{what} within {patience_s:.0f} s")
        time.sleep(0.05)


def run(network, kind, length_s, folder, settings):
    report = folder / f"{kind}_{length_s:g}"
    settings = ["--set", "time.sync=deterministic", *settings]
    nodes = [Node(host, report, settings) for host in HOSTS]
    row = {"kind": kind, "length_s": length_s, "went_back_to": [], "on_after_s": None, "stood_at": None, "why": ""}
    try:
        wait_for("the run begins", lambda: all(last_step(report, h) > 0 for h in HOSTS), 60)
        time.sleep(BEFORE_S)
        before = max(last_step(report, host) for host in HOSTS)
        network.outage(kind, length_s)
        healed = time.monotonic()
        newest = max(last_step(report, host) for host in HOSTS)
        row["stood_at"] = newest
        wait_for("all compute on", lambda: min(last_step(report, h) for h in HOSTS) > newest, WITHIN_S + 60)
        row["on_after_s"] = round(time.monotonic() - healed, 2)
        time.sleep(AFTER_S)
        lab("aurasim", 0, "send", "stop", LAUNCH, "--set", "dds.domain=186", *settings)
        for node in nodes:
            code = node.process.wait(60)
            node.reader.join(5)
            if code != 0:
                row["why"] += f"the process of host {node.host} ended with {code}. "
        states = sorted({state for node in nodes for _, state in node.went_back()})
        row["went_back_to"] = states
        if states and min(states) < min(before, BEFORE_S * 60) - 240:
            row["why"] += f"went back to state {min(states)}. "
        if row["on_after_s"] > WITHIN_S:
            row["why"] += f"went on {row['on_after_s']} s after the healing. "
        row["why"] += compare(report, folder, settings)
    except (TimeoutError, subprocess.SubprocessError) as error:
        row["why"] += f"{error}. "
    finally:
        for node in nodes:
            if node.process.poll() is None:
                os.killpg(node.process.pid, 9)
                node.process.wait()
    if row["why"]:
        for node in nodes:
            for at, line in node.lines:
                print(f"   {at % 1000:7.2f} {node.host}: {line}", file=sys.stderr)
    return row


def compare(report, folder, settings):
    merged = subprocess.run([AURASIM, "report", LAUNCH, report, *settings], cwd=ROOT, capture_output=True, text=True)
    if merged.returncode != 0:
        return f"report: {merged.stdout}{merged.stderr}. "
    steps = json.load(open(report / "summary.json"))["steps"]
    central = folder / f"{report.name}_central"
    subprocess.run([AURASIM, "launch", LAUNCH, "--headless", "--steps", str(steps), "--report", central, *settings,
                    "--set", "regions.count=1", "--set", "time.pace=none", "--set", "dds.domain=187"], cwd=ROOT,
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    same = subprocess.run([AURASIM, "compare", central, report], cwd=ROOT, capture_output=True, text=True)
    return "" if same.returncode == 0 else f"other bits: {same.stdout.strip()}. "


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("cases", nargs="+", help="KIND LENGTH, in turn")
    parser.add_argument("--table", help="one JSON object a line is appended here")
    parser.add_argument("--set", action="append", default=[], dest="settings")
    arguments = parser.parse_args()
    if os.geteuid() != 0 or not all(shutil.which(tool) for tool in ("ip", "nft")):
        print("skipped: needs root, ip and nft")
        return 77
    settings = [word for setting in arguments.settings for word in ("--set", setting)]
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        try:
            if subprocess.run([str(LAB), "up", str(len(HOSTS))]).returncode != 0:
                print("skipped: cannot make network namespaces")
                return 77
            network = Network()
            for kind, length in zip(arguments.cases[::2], arguments.cases[1::2]):
                row = run(network, kind, float(length), pathlib.Path(folder), settings)
                failed += bool(row["why"])
                print(json.dumps(row), flush=True)
                if arguments.table:
                    with open(arguments.table, "a") as table:
                        print(json.dumps(row), file=table)
        finally:
            lab("down")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
