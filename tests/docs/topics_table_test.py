#!/usr/bin/python3
"""docs/protocol.md has the table of topics that the program, the types and the profiles say. Takes the program's path."""
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def main():
    topics = subprocess.run([sys.argv[1], "schema", "--json", "topics"], check=True, capture_output=True).stdout
    table = subprocess.run([ROOT / "scripts" / "topics_table.py"], input=topics, check=True, capture_output=True).stdout
    if len(table.splitlines()) < 10:
        sys.exit("the table of topics has no rows")
    if table.decode() not in (ROOT / "docs" / "protocol.md").read_text():
        sys.exit("docs/protocol.md has another table of topics: scripts/write_keys.sh writes it")


if __name__ == "__main__":
    main()
