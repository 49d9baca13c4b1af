#!/usr/bin/env python3
"""Prints the table of topics of docs/protocol.md: src/topics/topics.cpp says name, type, partitions, who publishes and
who reads; idl/aurasim.idl says the key; qos/aurasim.xml says history, durability, heartbeat and blocking time.
    aurasim schema --json topics | scripts/topics_table.py"""
import json
import pathlib
import re
import sys
import xml.etree.ElementTree as ElementTree

ROOT = pathlib.Path(__file__).resolve().parent.parent


def keys_of_types():
    """Of each type the names of its key fields."""
    text = (ROOT / "idl" / "aurasim.idl").read_text()
    return {name: re.findall(r"@key [a-z ]*? (\w+);", body)
            for name, body in re.findall(r"struct (\w+) \{(.*?)\n\};", text, re.S)}


def writers():
    """Profiles of data writers by name, without the XML's namespace."""
    text = re.sub(r' xmlns="[^"]*"', "", (ROOT / "qos" / "aurasim.xml").read_text())
    return {writer.get("profile_name"): writer for writer in ElementTree.fromstring(text).iter("data_writer")}


def ms_at(writer, path):
    duration = writer.find(path)
    if duration is None:
        return None
    return int(duration.findtext("sec", "0")) * 1000 + int(duration.findtext("nanosec", "0")) / 1e6


def history(writer):
    kind = writer.findtext("topic/historyQos/kind").replace("_", " ").lower()
    depth = writer.findtext("topic/historyQos/depth", "")
    words = [f"{kind} {depth}".strip(), writer.findtext("qos/durability/kind").replace("_", " ").lower()]
    if writer.findtext("qos/reliability/kind") != "RELIABLE":
        words.append("best effort")
    if writer.findtext("qos/publishMode/kind") == "ASYNCHRONOUS":
        words.append("sent beside the steps")
    return ", ".join(words)


def times(writer):
    if writer.findtext("qos/reliability/kind") != "RELIABLE":
        return ""
    given = [ms_at(writer, "times/heartbeatPeriod"), ms_at(writer, "qos/reliability/max_blocking_time")]
    return ", ".join("default" if ms is None else f"{ms:g} ms" for ms in given)


def main():
    keys, profiles = keys_of_types(), writers()
    print("| topic | type | partition | key | published by | read by | history, durability | heartbeat, blocking | carries |")
    print("|---|---|---|---|---|---|---|---|---|")
    for topic in json.load(sys.stdin):
        kind = topic["type"].rsplit("::", 1)[1]
        partition = topic["partition"] + (" (and `/since/<n>`, see below)" if topic["by_life"] else "")
        writer = profiles[topic["name"] + "_writer"]
        print(f"| `{topic['name']}` | `{kind}` | {partition} | {', '.join(keys[kind])} | {', '.join(topic['published_by'])} "
              f"| {', '.join(topic['read_by'])} | {history(writer)} | {times(writer)} | {topic['carries']} |")


if __name__ == "__main__":
    main()
