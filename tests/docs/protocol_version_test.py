#!/usr/bin/python3
"""docs/protocol.md is of the version of the protocol that the code has: "version N (`kProtocolVersion` in `FILE`)"."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def main():
    page = (ROOT / "docs" / "protocol.md").read_text()
    named = re.search(r"[Vv]ersion\s+(\d+)\s+\(`kProtocolVersion`\s+in\s+`([^`]+)`\)", page)
    if not named:
        sys.exit("docs/protocol.md does not say of which version it is: \"version N (`kProtocolVersion` in `FILE`)\"")
    header = ROOT / named[2]
    constant = re.search(r"\bkProtocolVersion\s*=\s*(\d+)", header.read_text()) if header.exists() else None
    if not constant:
        sys.exit(f"docs/protocol.md looks for kProtocolVersion in {named[2]}, which does not define it")
    if constant[1] != named[1]:
        sys.exit(f"docs/protocol.md is of version {named[1]}, {named[2]} has {constant[1]}: bring the page up to date")
    print(f"protocol: version {named[1]}")


if __name__ == "__main__":
    main()
