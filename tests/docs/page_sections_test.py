#!/usr/bin/python3
"""scripts/page_sections.py: what a script writes of a page, and what it leaves."""
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
from page_sections import put_section, section_of  # noqa: E402

PAGE = """# Results

Written by a person.

<a id="first"></a>

## First

old

<!-- end of first -->

<a id="second"></a>

## Second

kept

<!-- end of second -->
"""


class PageSections(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.page = pathlib.Path(folder.name, "results.md")
        self.page.write_text(PAGE)

    def test_a_section_is_replaced_and_the_rest_stays(self):
        put_section(self.page, "first", "## First\n\nnew\n\n")
        self.assertEqual(self.page.read_text(), PAGE.replace("old", "new"))

    def test_the_same_section_again_changes_nothing(self):
        put_section(self.page, "second", section_of(self.page, "second"))
        self.assertEqual(self.page.read_text(), PAGE)

    def test_a_new_section_comes_at_the_end(self):
        put_section(self.page, "third", "## Third\n")
        self.assertEqual(self.page.read_text(), PAGE + '\n<a id="third"></a>\n\n## Third\n\n<!-- end of third -->\n')

    def test_a_page_that_is_not_there_is_begun(self):
        self.page.unlink()
        put_section(self.page, "first", "text")
        self.assertEqual(self.page.read_text(), '<a id="first"></a>\n\ntext\n\n<!-- end of first -->\n')

    def test_a_section_that_is_not_there_is_empty(self):
        self.assertEqual(section_of(self.page, "none"), "")
        self.assertEqual(section_of(self.page, "first"), "\n## First\n\nold\n\n")


if __name__ == "__main__":
    unittest.main()
