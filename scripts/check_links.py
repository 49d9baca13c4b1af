#!/usr/bin/python3
"""Do the pages lead where they say? Of README.md, docs/ and every other page that git tracks: relative links and their
anchors, and files that are named in backticks (not in CHANGELOG.md, which tells of files that are gone). Of comments in the code: the sections of docs/ that they name, and
decisions.

    scripts/check_links.py [ROOT]
"""
import argparse
import fnmatch
import pathlib
import re
import subprocess
import sys

LINK = re.compile(r"\]\(([^()\s]+)(?:\s+\"[^\"]*\")?\)")  # also of a picture within a link
CODE = re.compile(r"`([^`\n]+)`")
FENCE = re.compile(r"^( *)(```+|~~~+).*?^\1\2 *$", re.DOTALL | re.MULTILINE)
SECTION = re.compile(r"(docs/[\w/-]+\.md),\s+(?://[/!]?\s*|#\s*)?\"([^\"]+)\"")
DECISION = re.compile(r"docs/decisions/(\d{4}[\w.-]*)")
SOURCES = {".h", ".cpp", ".c", ".py", ".sh", ".idl", ".xml", ".js", ".mjs", ".yaml", ".txt", ".md"}
# What a run or a build leaves, not the repository.
MADE = {"build", "out", "node_modules", "dist", "figures", "region_N"}
HISTORY = "CHANGELOG.md"
# Where a path may begin that is written shorter than it is.
SHORT = ("", "src", "docs", "launch_configs", "scripts", "tests")


def tracked_files(root):
    try:
        listed = subprocess.run(["git", "-C", root, "ls-files", "--cached", "--others", "--exclude-standard"],
                                capture_output=True, text=True, check=True)
        files = listed.stdout.splitlines()
    except (OSError, subprocess.CalledProcessError):
        files = [str(p.relative_to(root)) for p in root.rglob("*") if p.is_file()]
    return [f for f in files if (root / f).is_file() and not MADE & set(pathlib.PurePath(f).parts)]


def slug(heading):
    """The anchor that GitHub makes of a heading."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).replace("`", "").strip().lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def headings(text):
    return [m.group(1).strip() for m in re.finditer(r"^#{1,6} +(.*?) *#*$", FENCE.sub("", text), re.MULTILINE)]


def anchors(text):
    found, times = set(), {}
    for heading in headings(text):
        name = slug(heading)
        found.add(f"{name}-{times[name]}" if name in times else name)
        times[name] = times.get(name, 0) + 1
    return found | set(re.findall(r"<a (?:id|name)=\"([^\"]+)\"", text))


class Checker:
    def __init__(self, root):
        self.root = root
        self.files = tracked_files(root)
        self.folders = {str(f) for file in self.files for f in pathlib.PurePath(file).parents} - {"."}
        self.names = {pathlib.PurePath(f).name for f in self.files}
        self.tops = {pathlib.PurePath(f).parts[0] for f in self.files}
        self.tops |= {pathlib.PurePath(f).parts[1] for f in self.files if f.startswith(("src/", "tests/", "docs/"))}
        self.anchors = {}
        self.problems = []

    def complain(self, page, text, position, what):
        self.problems.append(f"{page}:{text.count(chr(10), 0, position) + 1}: {what}")

    def anchors_of(self, page):
        if page not in self.anchors:
            self.anchors[page] = anchors((self.root / page).read_text())
        return self.anchors[page]

    def check_link(self, page, text, match):
        target = match.group(1)
        if re.match(r"[a-z][a-z+.-]*:", target):
            return  # another site
        path, _, anchor = target.partition("#")
        there = (self.root / page).parent / path if path else self.root / page
        if not there.exists():
            self.complain(page, text, match.start(), f"link to {target}: there is no {path}")
        elif anchor and there.suffix == ".md" and anchor not in self.anchors_of(there.resolve().relative_to(self.root)):
            self.complain(page, text, match.start(), f"link to {target}: {there.name} has no such heading")

    def exists(self, path):
        """`core/aura.h`, `qos/*.xml`, `src/core/`, `node/quorum` (.h and .cpp)."""
        path = path.rstrip("/")
        for start in SHORT:
            whole = f"{start}/{path}" if start else path
            if whole in self.folders or any(
                    fnmatch.fnmatchcase(f, w) for f in self.files for w in (whole, f"{whole}.h", f"{whole}.cpp")):
                return True
        return False

    def is_path(self, code):
        if not re.fullmatch(r"[\w.*-]+(/[\w.*-]+)*/?", code):
            return False
        parts = pathlib.PurePath(code).parts
        if set(parts) & MADE or code.startswith("/"):
            return False
        suffix = pathlib.PurePath(code).suffix
        if "/" in code:
            return parts[0] in self.tops
        return suffix in SOURCES - {".yaml", ".txt"}

    def check_code(self, page, text, match):
        code = match.group(1).split("(")[0].strip()
        if not self.is_path(code):
            return
        beside = (self.root / page).parent / code
        known = self.exists(code) or beside.exists() if "/" in code else (
            beside.exists() or any(fnmatch.fnmatchcase(name, code) for name in self.names))
        if not known:
            self.complain(page, text, match.start(), f"`{code}` is not there")

    def check_page(self, page):
        text = (self.root / page).read_text()
        prose = FENCE.sub(lambda m: re.sub(r"[^\n]", " ", m.group(0)), text)
        without_code = CODE.sub(lambda m: " " * len(m.group(0)), prose)
        for match in LINK.finditer(prose):
            if without_code[match.start()] != " " or prose[match.start()] == " ":
                self.check_link(page, text, match)
        if page == HISTORY:
            return
        for match in CODE.finditer(prose):
            self.check_code(page, text, match)

    def check_source(self, file):
        text = (self.root / file).read_text(errors="replace")
        for match in SECTION.finditer(text):
            page, section = match.group(1), " ".join(re.sub(r"\n\s*(//[/!]?|#)", " ", match.group(2)).split())
            if page not in self.files:
                self.complain(file, text, match.start(), f"there is no {page}")
            elif slug(section) not in self.anchors_of(page):
                self.complain(file, text, match.start(), f"{page} has no section \"{section}\"")
        for match in DECISION.finditer(text):
            decision = match.group(1).rstrip(".")
            if not any(f.startswith(f"docs/decisions/{decision}") for f in self.files):
                self.complain(file, text, match.start(), f"there is no docs/decisions/{decision}")

    def check(self):
        pages = [f for f in self.files if f.endswith(".md")]
        for page in pages:
            self.check_page(page)
        sources = [f for f in self.files if f.split("/")[0] in ("src", "tests", "idl", "scripts", "qos", "launch_configs")
                   and (pathlib.PurePath(f).suffix in SOURCES - {".md"}) and not f.startswith("tests/docs/")]
        for source in sources:
            self.check_source(source)
        return len(pages), len(sources)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", type=pathlib.Path, nargs="?", default=pathlib.Path(__file__).resolve().parent.parent)
    checker = Checker(parser.parse_args().root.resolve())
    pages, sources = checker.check()
    print("\n".join(checker.problems) if checker.problems else f"links: {pages} pages, {sources} source files")
    sys.exit(1 if checker.problems else 0)


if __name__ == "__main__":
    main()
