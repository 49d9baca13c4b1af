"""Sections of a page that scripts write, each between its marks, beside text that people write."""
import re


def marks_of(name):
    return f'<a id="{name}"></a>\n', f"<!-- end of {name} -->\n"


def put_section(page, name, text):
    """Puts `text` in place of what lies between the marks of the section `name`; everything else on the page stays. A page
    without these marks gets the section at its end."""
    begin, end = marks_of(name)
    old = page.read_text() if page.exists() else ""
    before, found, rest = old.partition(begin)
    after = rest.partition(end)[2]
    if not found and old:
        before = old.rstrip() + "\n\n"
    text = re.sub(r"\n{3,}", "\n\n", text).strip()
    page.write_text(f"{before}{begin}\n{text}\n\n{end}{after}")


def section_of(page, name):
    """What lies between the marks of the section `name`; nothing if the page has no such section."""
    begin, end = marks_of(name)
    old = page.read_text() if page.exists() else ""
    return old.partition(begin)[2].partition(end)[0]
