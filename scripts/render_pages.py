#!/usr/bin/python3
"""Puts stored results into the marked blocks of the pages.

    scripts/render_pages.py [--docs docs] [--check] [PAGE ...]

`aurasim-lab run SUITE` appends rows to docs/results/SUITE.jsonl. A page has blocks like these; the text around them is
written by people:

    <!-- table SUITE                        <!-- plot SUITE
    cases: stack_*/exact | chain_*          file: accuracy/pareto.png
    metrics: sunk | farthest                cases: front/* as the front | others/*
    rows: 1, metric                         x: CPU time of a step
    columns: 2                              y: error
    -->                                     scale: log log
    (the table)                             -->
    <!-- end -->                            (the picture)
                                            <!-- end -->

The parts of a case are divided by '/', and counted from 1; the last part that a block names (at least the second) is all of the rest. Each (case, metric) has the value of its newest full run.
  cases    patterns of cases, with | between them; in a plot each pattern is a line, and "as NAME" names it. All if left out
  metrics  which, in this order; all if left out; "!a | !b" is all but those
  rows     what names a row: numbers of parts, and the word metric; 2 if left out
  columns  the number of the part that names a column; metric if left out; "2: a | b" shows those columns in that order
           With a part as column and no metric in rows, a cell holds the values of all metrics: "late / missed".
  heads    headings of the row's names
  x, y     a metric; y may be several, with | between them; x may be the number of a part, which is read as a number
           ("1_60 s" is 1/60), and then heads names it
--check changes nothing. The exit code is then 1 if a page does not say what the results say.
"""
import argparse
import fnmatch
import json
import pathlib
import re
import sys

BLOCK = re.compile(r"<!-- (table|plot) (\w+)\n(.*?)-->\n(.*?)<!-- end -->", re.DOTALL)


class PageError(Exception):
    pass


def split(text, mark="|"):
    return [part.strip() for part in text.split(mark) if part.strip()]


def newest_rows(file):
    """{(case, metric): row} of the newest full run of each, in the order in which the newest run has them."""
    if not file.exists():
        raise PageError(f"{file}: there is no such file. Run `aurasim-lab run {file.stem} --full`")
    rows = {}
    for number, line in enumerate(file.read_text().splitlines(), 1):
        try:
            row = json.loads(line)
            key = row["case"], row["metric"]
            full = row["run"] == "full"
        except (ValueError, KeyError, TypeError) as error:
            raise PageError(f"{file}:{number}: not a row of results ({error})") from None
        if full:
            rows.pop(key, None)
            rows[key] = row
    return rows


class Block:
    """What a page asks for, and the rows that it means."""

    def __init__(self, folder, where, suite, spec):
        self.where = f"{where}, block of {suite}"
        self.spec = {}
        for line in spec.strip().splitlines():
            key, _, value = line.partition(":")
            if key.strip() not in ("cases", "metrics", "rows", "columns", "heads", "file", "x", "y", "scale"):
                raise PageError(f"{self.where}: unknown key {key.strip()!r}")
            self.spec[key.strip()] = value.strip()
        named = split(self.spec.get("metrics", ""))
        self.metrics = [m for m in named if not m.startswith("!")]
        others = [m[1:] for m in named if m.startswith("!")]
        self.patterns = [split(p, " as ") for p in split(self.spec.get("cases", "*"))]
        self.rows = [r for r in newest_rows(folder / f"{suite}.jsonl").values()
                     if (not self.metrics or r["metric"] in self.metrics) and r["metric"] not in others
                     and self.line_of(r) is not None]
        if self.metrics:
            self.rows.sort(key=lambda r: self.metrics.index(r["metric"]))
        if not self.rows:
            raise PageError(f"{self.where}: no stored row has one of its cases ({self.spec.get('cases')}) and metrics")

    def line_of(self, row):
        """Number of the first pattern that the case matches; None if there is none."""
        return next((i for i, p in enumerate(self.patterns) if fnmatch.fnmatchcase(row["case"], p[0])), None)

    def measured(self):
        found = dict.fromkeys((r["commit"], r["date"], r["machine"]) for r in self.rows)
        return "Measured: " + "; ".join(f"commit {c}, {d}, {m}" for c, d, m in found) + ".\n"


def number(value):
    if value is None:
        return "none"
    if float(value).is_integer() and abs(value) < 1e7:
        return f"{int(value)}"
    return f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"


def with_unit(name, unit):
    return name if unit in ("1", "ratio") else f"{name}, {unit}"


def name_of(row, field, parts):
    if field == "metric":
        return with_unit(row["metric"], row["unit"])
    found = row["case"].split("/", parts - 1)
    return found[int(field) - 1] if int(field) <= len(found) else ""


def table(block):
    row_fields = split(block.spec.get("rows", "2"), ",")
    column_field, _, wanted = block.spec.get("columns", "metric").partition(":")
    columns = dict.fromkeys(split(wanted))
    parts = max(int(f) for f in row_fields + [column_field.strip(), "2"] if f.isdigit())
    lines = {}
    for row in block.rows:
        column = name_of(row, column_field.strip(), parts)
        if wanted and column not in columns:
            continue
        columns[column] = None
        cells = lines.setdefault(tuple(name_of(row, f, parts) for f in row_fields), {})
        cells.setdefault(column, []).append(number(row["value"]))
    heads = split(block.spec.get("heads", "")) or [""] * len(row_fields)
    if block.metrics and "metric" not in row_fields:  # their order is that of the metrics, not of the cases
        in_order = {tuple(name_of(r, f, parts) for f in row_fields): None for r in sorted(block.rows, key=block.line_of)}
        lines = {key: lines[key] for key in in_order if key in lines}
    text = ["| " + " | ".join(escaped(h) for h in heads + list(columns)) + " |", "|" + "---|" * (len(heads) + len(columns))]
    for names, cells in lines.items():
        found = [" / ".join(cells.get(c, [])) for c in columns]
        text.append("| " + " | ".join([escaped(n) for n in names] + found) + " |")
    return "\n".join(text) + "\n"


def escaped(text):
    return text.replace("|", "\\|").replace("1_", "1/") if re.match(r"1_\d", text) else text.replace("|", "\\|")


def coordinate(text):
    match = re.search(r"1_(\d+)", text)
    if match:
        return 1 / float(match[1])
    match = re.search(r"-?\d+(\.\d+)?", text)
    return float(match[0]) if match else None


def points_of(block):
    """{line: [(x, y)]}, the unit of x, and the label of y."""
    x_name, y_names = block.spec["x"], split(block.spec["y"])
    by_case = {}
    for row in block.rows:
        by_case.setdefault(row["case"], {})[row["metric"]] = row
    lines, x_unit, y_units = {}, "", {}
    for metrics in by_case.values():
        y = next((metrics[name] for name in y_names if name in metrics), None)
        if y is None:
            continue
        x = coordinate(name_of(y, x_name, int(x_name))) if x_name.isdigit() else metrics.get(x_name, {}).get("value")
        if x is None or y["value"] is None:
            continue
        pattern = block.patterns[block.line_of(y)]
        lines.setdefault(pattern[-1], []).append((x, y["value"]))
        y_units[y["unit"]] = None
        x_unit = "1" if x_name.isdigit() else metrics[x_name]["unit"]
    if not lines:
        raise PageError(f"{block.where}: no row has both {x_name!r} and {block.spec['y']!r}")
    y_label = with_unit(y_names[0], *y_units) if len(y_names) == 1 else "error, " + " or ".join(y_units)
    return lines, x_unit, y_label


def plot(block, docs, check):
    file = block.spec["file"]
    if not check:
        import matplotlib  # pylint: disable=import-outside-toplevel
        matplotlib.use("Agg")
        from matplotlib import pyplot  # pylint: disable=import-outside-toplevel
        lines, x_unit, y_label = points_of(block)
        figure, axes = pyplot.subplots(figsize=(8, 5))
        for name, points in lines.items():
            axes.plot(*zip(*sorted(points)), marker="o", markersize=4, label=name,
                      linewidth=0.8 if block.spec["x"].isdigit() else 0)
        scales = block.spec.get("scale", "linear linear").split()
        axes.set(xscale=scales[0], yscale=scales[1], ylabel=y_label,
                 xlabel=block.spec.get("heads") or with_unit(block.spec["x"], x_unit))
        axes.grid(alpha=0.3, which="both")
        axes.legend(fontsize=8)
        figure.tight_layout()
        (docs / file).parent.mkdir(exist_ok=True)
        figure.savefig(docs / file, dpi=110, metadata={"Software": None})
        pyplot.close(figure)
    elif not (docs / file).exists():
        raise PageError(f"{block.where}: there is no picture {file}")
    return f"![{pathlib.Path(file).stem}]({file})\n"


def rendered(page, docs, check):
    def replacement(match):
        kind, suite, spec, _ = match.groups()
        block = Block(docs / "results", page, suite, spec)
        try:
            body = table(block) if kind == "table" else plot(block, docs, check)
        except (KeyError, ValueError) as error:
            raise PageError(f"{block.where}: {error} is missing or wrong") from None
        return f"<!-- {kind} {suite}\n{spec}-->\n\n{body}\n{block.measured()}\n<!-- end -->"

    text = page.read_text()
    whole = len(re.findall(r"^<!-- (?:table|plot) ", text, re.MULTILINE))
    if whole != len(BLOCK.findall(text)):
        raise PageError(f"{page}: a block has no end (`<!-- end -->`)")
    return text, BLOCK.sub(replacement, text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pages", nargs="*", type=pathlib.Path)
    parser.add_argument("--docs", type=pathlib.Path, default=pathlib.Path(__file__).parent.parent / "docs")
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    stale = 0
    for page in arguments.pages or sorted(arguments.docs.glob("*.md")):
        try:
            before, after = rendered(page, arguments.docs, arguments.check)
        except PageError as error:
            sys.exit(str(error))
        if before == after:
            continue
        if arguments.check:
            print(f"{page}: does not say what docs/results says. Run scripts/render_pages.py")
            stale = 1
        else:
            page.write_text(after)
            print(f"{page}: written")
    sys.exit(stale)


if __name__ == "__main__":
    main()
