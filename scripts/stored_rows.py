"""What scripts that measure whole runs share: the build, and rows in docs/results as `aurasim-lab run` appends them."""
import datetime
import json
import os
import pathlib
import platform
import statistics
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent


def build(*targets):
    subprocess.run([ROOT / "scripts" / "build.sh", "release", "aurasim", *targets], check=True, stdout=subprocess.DEVNULL)


def commit():
    """Of the sources, with "-dirty" when one was changed after it."""
    said = subprocess.run(["git", "-C", ROOT, "describe", "--always", "--abbrev=10", "--dirty", "--exclude=*"],
                          capture_output=True, text=True, check=False)
    return said.stdout.strip() or "unknown"


def machine():
    model = platform.machine()
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            model = line.split(":", 1)[1].strip()
            break
    return f"{os.cpu_count()} cores, {model}"


def percentile(values, share):
    values = sorted(values)
    return values[min(len(values) - 1, int(share * len(values)))] if values else None


class Rows:
    """Gathers values by case and metric, and stores the median of each."""

    def __init__(self):
        self.values = {}

    def add(self, case, metric, value, unit="1"):
        if value is not None:
            self.values.setdefault((case, metric, unit), []).append(value)

    def median(self, case, metric):
        return next(statistics.median(v) for (c, m, _), v in self.values.items() if (c, m) == (case, metric))

    def store(self, suite, folder=ROOT / "docs" / "results"):
        about = {"commit": commit(), "date": f"{datetime.datetime.now(datetime.timezone.utc):%Y-%m-%d}", "machine": machine(),
                 "run": "full"}
        folder.mkdir(parents=True, exist_ok=True)
        with open(folder / f"{suite}.jsonl", "a") as file:
            for (case, metric, unit), values in self.values.items():
                row = {"case": case, "metric": metric, "value": float(f"{statistics.median(values):.6g}"), "unit": unit,
                       "n": len(values)}
                file.write(json.dumps(row | about, separators=(",", ":")) + "\n")
        print(f"{len(self.values)} rows appended to {folder / suite}.jsonl; scripts/render_pages.py shows them")
