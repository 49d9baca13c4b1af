#!/usr/bin/env python3
"""What it costs a healthy run that its nodes keep parts of the world for each other: frames and bytes, with and without,
by turns. Writes DIR/cost.jsonl, and the medians as the suite recovery."""
import argparse
import json
import pathlib
import subprocess
import tempfile

from stored_rows import Rows


def frames(report):
    """The median of the nodes' 50th and 99th percentiles, ms."""
    regions = json.loads((pathlib.Path(report) / "summary.json").read_text())["regions"]
    middle = lambda name, part: sorted(r[name][part] for r in regions)[len(regions) // 2]
    return {"p50": middle("frame_ms", "p50"), "p99": middle("frame_ms", "p99")}


def add(rows, run):
    case = f"cost/{run['scene']}/{run['rule']}"
    rows.add(case, "frame p50", run["p50"], "ms")
    rows.add(case, "frame p99", run["p99"], "ms")
    rows.add(case, "to neighbours", run["aura_bytes"] / run["seconds"] / 1e3, "kB/s")
    rows.add(case, "to keepers", run["bytes"] / run["seconds"] / 1e3, "kB/s")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default="build/release/aurasim")
    parser.add_argument("--scenes", default="demo,columns_rain")
    parser.add_argument("--steps", type=int, default=1200)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--domain", type=int, default=73)
    parser.add_argument("--out", default="build/recovery")
    options = parser.parse_args()
    rows = Rows()
    with (pathlib.Path(options.out) / "cost.jsonl").open("w") as file:
        for scene in options.scenes.split(","):
            for repeat in range(options.repeats):
                for rule in ("stop", "recover"):
                    with tempfile.TemporaryDirectory() as folder:
                        subprocess.run(
                            [options.program, "launch", f"launch_configs/{scene}.yaml", "--headless", "--steps",
                             str(options.steps), "--report", folder, "--set", f"dds.domain={options.domain}", "--set",
                             "time.sync=deterministic", "--set", f"survival.on_death={rule}"],
                            check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                        row = {"scene": scene, "rule": rule, "repeat": repeat, **frames(folder)}
                        nodes = [json.loads(p.read_text()) for p in pathlib.Path(folder).glob("region_*/node.json")]
                        row["bytes"] = sum(n.get("checkpoint_bytes", 0) for n in nodes)
                        row["aura_bytes"] = sum(n.get("sent_bytes", 0) for n in nodes)
                        row["seconds"] = options.steps / 60
                        file.write(json.dumps(row) + "\n")
                        print(json.dumps(row), flush=True)
                        add(rows, row)
    for scene in options.scenes.split(","):
        less, more = (rows.median(f"cost/{scene}/{rule}", "frame p99") for rule in ("stop", "recover"))
        rows.add(f"cost/{scene}/recover", "p99 over that of stop", more / less, "ratio")
    rows.store("recovery")


if __name__ == "__main__":
    main()
