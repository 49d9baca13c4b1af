#!/usr/bin/env python3
"""What a page is sent of many bodies that all move: a run with an overseer, and a page that says what its camera sees.
Writes DIR/pages.jsonl and docs/results.md#page_traffic."""
import argparse
import json
import pathlib
import re
import subprocess
import tempfile
import time

from page_sections import put_section
from report_parts import machine_line, measured_line, table

TEXT = """## What a page is sent

{measured}

Written by `scripts/page_traffic.sh`; do not edit. {machine}.

{bodies} balls roll over a plane of {side:.0f} m x {side:.0f} m, on two nodes. The viewer shows them 20 times a second, in a picture of
1280 x 800 pixels. A page says what its camera sees ([viewer.md](viewer.md)), and is sent only bodies that the picture may
show. Bodies far away that would move by less than a pixel are sent less often. Counted is all that comes over TCP.

{pages}"""

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


def write(options):
    rows = [json.loads(line) for line in (options.out / "pages.jsonl").read_text().splitlines()]
    pages = table(["what the page sees", "kB/s", "of all", "frames/s"],
                  [[row["kind"], f"{row['kB_s']:.0f}", f"{100 * row['kB_s'] / rows[0]['kB_s']:.1f}%", row["frames_s"]] for row in rows])
    text = TEXT.format(measured=measured_line(options.out), machine=machine_line(), bodies=f"{options.bodies:,}",
                       side=options.spacing * options.bodies**0.5, pages=pages.strip() + "\n")
    put_section(pathlib.Path("docs/results.md"), "page_traffic", text)


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
    measure(options)
    write(options)


if __name__ == "__main__":
    main()
