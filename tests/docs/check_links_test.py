#!/usr/bin/python3
"""scripts/check_links.py on small folders: what it complains about, and what it lets be."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts" / "check_links.py"
FILES = {
    "docs/design.md": "# The design\n\n## One step\n\n## The `aura` and its reach\n\n```\n## No heading\n```\n",
    "docs/decisions/0001-flat-batches.md": "# 0001: Flat batches\n",
    "src/core/aura.h": "// docs/design.md, \"One step\"\n",
    "src/core/aura.cpp": "",
    "qos/hosts.xml": "",
}


def complaints(**changed):
    """Of a folder with FILES and other ones: its name with __ for / and _ for the dot, and what is in it."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in (FILES | {n.replace("__", "/").replace("_", "."): t for n, t in changed.items()}).items():
            path = pathlib.Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        run = subprocess.run([sys.executable, SCRIPT, folder], capture_output=True, text=True, check=False)
        assert run.returncode == (0 if run.stdout.startswith("links:") else 1), run.stdout + run.stderr
        return [] if run.returncode == 0 else run.stdout.splitlines()


class CheckLinks(unittest.TestCase):
    def test_what_is_there_is_let_be(self):
        self.assertEqual(complaints(README_md="[a](docs/design.md#one-step) [b](https://example.org/none) [c](#here)\n"
                                              "[d](docs/design.md#the-aura-and-its-reach) [e](docs)\n\n# Here\n"), [])

    def test_a_link_to_nowhere(self):
        self.assertEqual(complaints(README_md="# A\n\n[a](docs/none.md)\n"),
                         ["README.md:3: link to docs/none.md: there is no docs/none.md"])

    def test_a_link_is_relative_to_its_page(self):
        self.assertEqual(len(complaints(docs__other_md="[a](docs/design.md)\n")), 1)
        self.assertEqual(complaints(docs__other_md="[a](design.md) [b](../qos/hosts.xml)\n"), [])

    def test_an_anchor_that_no_heading_has(self):
        self.assertEqual(len(complaints(README_md="[a](docs/design.md#two-steps)\n")), 1)
        self.assertEqual(len(complaints(README_md="[a](#nothing)\n")), 1)

    def test_a_heading_within_code_is_none(self):
        self.assertEqual(len(complaints(README_md="[a](docs/design.md#no-heading)\n")), 1)

    def test_a_picture_that_is_not_there(self):
        self.assertEqual(len(complaints(README_md="![a picture](docs/demo.gif)\n")), 1)

    def test_a_link_around_a_picture(self):
        self.assertEqual(len(complaints(README_md="[![a](docs/demo.gif)](docs/none.md)\n")), 2)

    def test_code_that_names_a_file(self):
        self.assertEqual(complaints(README_md="`core/aura.h` `src/core/aura.cpp` `core/aura` `aura.h` `qos/*.xml` "
                                              "`src/core/` `hosts.xml`\n"), [])
        self.assertEqual(len(complaints(README_md="`core/aurora.h` `src/kore/` `aurora.h` `core/aurora` `qos/*.yaml`\n")), 5)

    def test_the_changelog_may_name_files_that_are_gone(self):
        self.assertEqual(complaints(CHANGELOG_md="`docs/gone.md`\n"), [])
        self.assertEqual(len(complaints(CHANGELOG_md="[a](docs/gone.md)\n")), 1)

    def test_other_code_is_let_be(self):
        self.assertEqual(complaints(README_md="`time.sync` `region/2` `/api/shapes` `build/release/aurasim` `a/b` "
                                              "`out/summary.json` `steps.csv` `frame.p50`\n"), [])

    def test_blocks_of_code_are_let_be(self):
        self.assertEqual(complaints(README_md="```\n[a](none.md) `core/none.h`\n```\n"), [])

    def test_a_link_within_code_is_none(self):
        self.assertEqual(complaints(README_md="`[a](none.md)`\n"), [])

    def test_a_comment_that_names_a_section(self):
        self.assertEqual(complaints(src__core__a_h='// (docs/design.md, "The aura and its\n/// reach").\n'), [])
        self.assertEqual(len(complaints(src__core__a_h='// docs/design.md, "The halo"\n')), 1)
        self.assertEqual(len(complaints(src__core__a_h='// docs/desing.md, "One step"\n')), 1)

    def test_a_comment_that_names_a_decision(self):
        self.assertEqual(complaints(src__core__a_h="// docs/decisions/0001. docs/decisions/0001-flat-batches.md\n"), [])
        self.assertEqual(len(complaints(src__core__a_h="// (docs/decisions/0002)\n")), 1)


if __name__ == "__main__":
    unittest.main()
