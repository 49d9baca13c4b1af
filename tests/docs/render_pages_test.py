#!/usr/bin/python3
"""scripts/render_pages.py: what it puts into the blocks of a page, what it leaves, and what it refuses."""
import json
import pathlib
import subprocess
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "render_pages.py"
PAGE = """# A page

Written by a person.

<!-- table suite
cases: */fast | */exact
metrics: sunk
rows: 1
columns: 2
heads: pile
-->
<!-- end -->

The end.
"""


class RenderPages(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.docs = pathlib.Path(folder.name)
        self.page = self.docs / "page.md"
        self.page.write_text(PAGE)
        (self.docs / "results").mkdir()
        self.store("stack/fast", "sunk", 0.25, unit="m")
        self.store("stack/exact", "sunk", 0.125, unit="m")
        self.store("house/fast", "sunk", 2, unit="m")

    def store(self, case, metric, value, unit="1", commit="abc", run="full"):
        row = {"case": case, "metric": metric, "value": value, "unit": unit, "n": 1, "commit": commit,
               "date": "2026-01-02", "machine": "4 cores", "run": run}
        with open(self.docs / "results" / "suite.jsonl", "a") as file:
            file.write(json.dumps(row) + "\n")

    def render(self, *options, code=0):
        done = subprocess.run([SCRIPT, "--docs", self.docs, *options], capture_output=True, text=True,
                              check=False)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout + done.stderr

    def lines(self):
        self.render()
        return [line for line in self.page.read_text().splitlines() if line.startswith(("|", "Measured"))]

    def test_a_table_is_filled_and_the_rest_stays(self):
        self.assertEqual(self.lines(), ["| pile | fast | exact |", "|---|---|---|", "| stack | 0.25 | 0.125 |",
                                        "| house | 2 |  |", "Measured: commit abc, 2026-01-02, 4 cores."])
        text = self.page.read_text()
        self.assertTrue(text.startswith("# A page\n\nWritten by a person.\n\n<!-- table suite\n"))
        self.assertTrue(text.endswith("<!-- end -->\n\nThe end.\n"))

    def test_the_same_results_again_change_nothing(self):
        self.render()
        self.assertEqual(self.render(), "")
        self.render("--check")

    def test_the_newest_full_run_counts(self):
        self.store("stack/exact", "sunk", 0.5, unit="m", commit="def")
        self.store("stack/exact", "sunk", 9, unit="m", commit="fed", run="quick")
        lines = self.lines()
        self.assertIn("| stack | 0.25 | 0.5 |", lines)
        self.assertEqual(lines[-1], "Measured: commit abc, 2026-01-02, 4 cores; commit def, 2026-01-02, 4 cores.")

    def test_a_page_that_says_something_else_is_found(self):
        self.render()
        self.page.write_text(self.page.read_text().replace("0.125", "0.001"))
        self.assertIn("page.md: does not say", self.render("--check", code=1))
        self.assertIn("0.001", self.page.read_text())

    def test_columns_in_a_given_order(self):
        self.page.write_text(PAGE.replace("columns: 2", "columns: 2: exact | fast"))
        self.assertEqual(self.lines()[2], "| stack | 0.125 | 0.25 |")

    def test_metrics_as_columns_with_their_units(self):
        self.store("stack/fast", "fallen", 3)
        self.page.write_text(PAGE.replace("metrics: sunk", "metrics: fallen | sunk").replace("columns: 2", "columns: metric")
                             .replace("*/fast | */exact", "stack/fast"))
        self.assertEqual(self.lines()[:3], ["| pile | fallen | sunk, m |", "|---|---|---|", "| stack | 3 | 0.25 |"])

    def test_several_metrics_in_a_cell(self):
        self.store("stack/fast", "fallen", 3)
        self.page.write_text(PAGE.replace("metrics: sunk", "metrics: fallen | sunk"))
        self.assertIn("| stack | 3 / 0.25 | 0.125 |", self.lines())

    def test_all_metrics_but_one(self):
        self.store("stack/fast", "fallen", 3)
        self.page.write_text(PAGE.replace("metrics: sunk", "metrics: !sunk").replace("rows: 1", "rows: 1, metric")
                             .replace("heads: pile", "heads: pile | measured"))
        self.assertEqual(self.lines()[2:-1], ["| stack | fallen | 3 |"])

    def test_a_value_that_is_no_number(self):
        self.store("stack/exact", "sunk", None, unit="m")
        self.assertIn("| stack | 0.25 | none |", self.lines())

    def test_a_picture(self):
        self.store("stack/fast", "time", 5, unit="us")
        self.page.write_text("<!-- plot suite\nfile: pictures/a.png\ncases: */fast as fast ones\nx: time\ny: sunk\n-->\n<!-- end -->\n")
        self.assertIn("there is no picture", self.render("--check", code=1))
        self.render()
        self.assertTrue((self.docs / "pictures" / "a.png").read_bytes().startswith(b"\x89PNG"))
        self.assertIn("\n![a](pictures/a.png)\n", self.page.read_text())
        self.render("--check")

    def test_what_is_wrong_is_named(self):
        for wrong, said in ((PAGE.replace("heads:", "head:"), "unknown key 'head'"),
                            (PAGE.replace("*/fast", "*/quick").replace("*/exact", "no"), "no stored row"),
                            (PAGE.replace("rows: 1", "rows: one"), "is missing or wrong"),
                            (PAGE.replace("table suite", "table none"), "aurasim-lab run none --full"),
                            (PAGE.replace("<!-- end -->", ""), "has no end")):
            self.page.write_text(wrong)
            self.assertIn(said, self.render(code=1))
            self.assertEqual(self.page.read_text(), wrong)

    def test_a_line_that_is_no_row_is_named(self):
        with open(self.docs / "results" / "suite.jsonl", "a") as file:
            file.write("{}\n")
        self.assertIn("suite.jsonl:4: not a row of results", self.render(code=1))


if __name__ == "__main__":
    unittest.main()
