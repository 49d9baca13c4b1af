#!/usr/bin/env python3
"""What a page is sent of many bodies that all move: a run with an overseer, and a page that says what its camera sees.
Writes DIR/pages.jsonl, and the suite page_traffic. About 3 minutes."""
import argparse
import json
import pathlib
import re
import subprocess
import tempfile
import time

from stored_rows import ROOT, Rows, build

KINDS = (("all, as a page that does not say what it sees", []),
         ("the whole plane, from 1.5 widths away", ["--eye={far},0,{high}", "--towards={far_x},0,{far_z}"]),
         ("from within, at eye level", ["--eye=0,0,2", "--towards=1,0,-0.05"]),
         ("from within, 10 m high, looking down by 45 degrees", ["--eye=0,0,10", "--towards=0.7071,0,-0.7071"]),
         ("a tab that is hidden", ["--hidden"]))


def scene(folder, bodies, side):
    per_row = int(bodies**0.5)
    spacing = side / per_row
    rows = "\n".join(f"  - {{prototype: ball, position: [{spacing * (i % per_row - per_row / 2):.2f}, "
                     f"{spacing * (i // per_row - per_row / 2):.2f}, 0.3], velocity: [{(i * 7 % 5 - 2) / 2}, {(i * 3 % 5 - 2) / 2}, 0]}}"
                     for i in range(bodies))
    (folder / "balls.yaml").write_text(f"""name: balls
materials: {{smooth: {{friction: 0.3, restitution: 0.8}}}}
shapes: {{ball: {{sphere: {{radius: 0.3}}}}}}
prototypes: {{ball: {{shape: ball, mass: 1, material: smooth, can_sleep: false}}}}
statics: [{{name: ground, material: smooth, shape: {{plane: {{}}}}}}]
bodies:
{rows}
""")
    file = folder / "launch.yaml"
    file.write_text("scene: balls.yaml\nregions: {layout: columns, count: 2, width: 200}\n")
    return file


def address_of(log, run):
    end = time.monotonic() + 60
    while time.monotonic() < end and run.poll() is None:
        found = re.search(r"http://127\.0\.0\.1:\d+/\S*", log.read_text())
        if found:
            return found.group(0)
        time.sleep(0.2)
    raise RuntimeError(f"no page: {log.read_text()}")


def measure(options):
    side = options.spacing * options.bodies**0.5
    places = {"far": f"{-1.5 * side:.0f}", "high": f"{side:.0f}", "far_x": "0.832", "far_z": "-0.555"}
    with tempfile.TemporaryDirectory() as temporary, (options.out / "pages.jsonl").open("w") as out:
        folder = pathlib.Path(temporary)
        file, log = scene(folder, options.bodies, side), folder / "log.txt"
        run = subprocess.Popen([options.program, "launch", str(file), "--set", f"dds.domain={options.domain}", "--set",
                                "overseer.port=0"], stdout=log.open("w"), stderr=subprocess.STDOUT)
        try:
            url = address_of(log, run)
            time.sleep(5)
            for name, arguments in KINDS:
                words = [argument.format(**places) for argument in arguments]
                said = subprocess.run(["node", "tests/web/traffic.mjs", url, "--seconds", str(options.seconds), *words],
                                      capture_output=True, text=True, check=True, timeout=options.seconds + 60)
                row = {"kind": name, **json.loads(said.stdout)}
                out.write(json.dumps(row) + "\n")
                print(json.dumps(row), flush=True)
        finally:
            run.terminate()
            run.wait(60)


def store(options):
    pages = [json.loads(line) for line in (options.out / "pages.jsonl").read_text().splitlines()]
    rows = Rows()
    for page in pages:
        rows.add(f"page/{page['kind']}", "traffic", page["kB_s"], "kB/s")
        rows.add(f"page/{page['kind']}", "of all", 100 * page["kB_s"] / pages[0]["kB_s"], "%")
        rows.add(f"page/{page['kind']}", "frames a second", page["frames_s"])
    rows.store("page_traffic")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default="build/release/aurasim")
    parser.add_argument("--bodies", type=int, default=10_000)
    parser.add_argument("--spacing", type=float, default=3.0)
    parser.add_argument("--seconds", type=int, default=20)
    parser.add_argument("--domain", type=int, default=76)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("build/page_traffic"))
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    build()
    subprocess.run([ROOT / "scripts" / "build_web.sh", "--tests"], check=True)
    measure(options)
    store(options)


if __name__ == "__main__":
    main()
