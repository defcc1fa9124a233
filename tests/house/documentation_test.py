"""Links and paths of the documentation lead somewhere."""
import pathlib
import re
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = "core residuals solvers apps tests benchmarks datasets scripts docs".split()
MADE = {"datasets/recordings",  # by scripts/fetch_recordings.sh
        "apps/all"}  # a target of Ninja
LINK = re.compile(r"\]\(([^)\s]+)\)")
PATH = re.compile(r"(?<![\w./<-])(?:" + "|".join(FOLDERS) + r")/[\w./<>*-]*")


def pages(root):
    skipped = {"node_modules", "build", "out"}
    return [p for p in sorted(root.rglob("*.md")) if not skipped & set(p.relative_to(root).parts)]


def anchors(text):
    """The names that headings get: lower case, blanks to dashes, other marks left out."""
    headings = re.findall(r"^#+ +(.*)$", re.sub(r"```.*?```", "", text, flags=re.S), flags=re.M)
    return {re.sub(r"[^\w -]", "", h.lower()).strip().replace(" ", "-") for h in headings}


def broken_links(root):
    broken = []
    for page in pages(root):
        for link in LINK.findall(page.read_text(encoding="utf-8")):
            if re.match(r"\w+:", link):
                continue
            path, _, anchor = link.partition("#")
            target = page.parent / path if path else page
            name = f"{page.relative_to(root)}: {link}"
            if not target.exists():
                broken.append(name)
            elif anchor and anchor not in anchors(target.read_text(encoding="utf-8")):
                broken.append(name)
    return broken


def code_of(text):
    """What stands between backticks, a piece each, and the lines of fenced blocks."""
    fenced = re.findall(r"```.*?\n(.*?)```", text, flags=re.S)
    rest = re.sub(r"```.*?```", "", text, flags=re.S)
    return [line for block in fenced for line in block.splitlines()] + re.findall(r"`([^`\n]+)`", rest)


def without_old_paths(text):
    """A changelog without the first column of its tables, which tells where things were, and what it says was split."""
    text = re.sub(r"^\| [^|]* \|", "|", text, flags=re.M)
    return re.sub(r"^- Split: .*?(?=^- |^\n|\Z)", "", text, flags=re.M | re.S)


def missing_paths(root):
    missing = []
    for page in pages(root):
        text = page.read_text(encoding="utf-8")
        if page.name == "CHANGELOG.md":
            text = without_old_paths(text)
        for code in code_of(text):
            for path in PATH.findall(code):
                path = path.rstrip(".").rstrip("/")
                if "<" in path or path in MADE:
                    continue
                found = list(root.glob(path)) or list(root.glob(path + ".cc")) or list((page.parent).glob(path))
                if not found:
                    missing.append(f"{page.relative_to(root)}: {path}")
    return missing


class ThisTree(unittest.TestCase):
    def test_has_pages(self):
        self.assertGreaterEqual(len(pages(ROOT)), 10)

    def test_links_lead_somewhere(self):
        self.assertEqual(broken_links(ROOT), [])

    def test_paths_exist(self):
        self.assertEqual(missing_paths(ROOT), [])

    def test_readme_names_every_page(self):
        """From the README on, every page of docs/ is reached."""
        links = LINK.findall((ROOT / "README.md").read_text(encoding="utf-8"))
        for page in sorted((ROOT / "docs").glob("*.md")) + [ROOT / "CONTRIBUTING.md"]:
            self.assertIn(str(page.relative_to(ROOT)), links)

    def test_one_version(self):
        """CMake's, the citation's and that of the newest entry of the changelog."""
        for file, pattern in (("CITATION.cff", r"^version: (\S+)$"), ("CHANGELOG.md", r"^## \[(\d[^\]]*)\]")):
            version = re.search(pattern, (ROOT / file).read_text(encoding="utf-8"), flags=re.M)[1]
            self.assertIn(f"project(idim VERSION {version} ", (ROOT / "CMakeLists.txt").read_text(), file)

    def test_readme_is_short(self):
        self.assertLessEqual(len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()), 120)


class Planted(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)
        (self.root / "core").mkdir()
        (self.root / "core/a.h").write_text("")
        (self.root / "docs").mkdir()
        (self.root / "docs/b.md").write_text("# A `b`, or two\n")

    def tearDown(self):
        self.folder.cleanup()

    def write(self, text, name="README.md"):
        (self.root / name).write_text(text)

    def test_a_sound_page(self):
        self.write("[b](docs/b.md#a-b-or-two) [web](https://a.b/c) `core/a.h` `core/*.h` `core/<x>.h`\n"
                   "```sh\ncat core/a.h\n```\n")
        self.assertEqual(broken_links(self.root), [])
        self.assertEqual(missing_paths(self.root), [])

    def test_a_link_to_nothing(self):
        self.write("[b](docs/c.md)")
        self.assertEqual(broken_links(self.root), ["README.md: docs/c.md"])

    def test_a_heading_that_is_not_there(self):
        self.write("[b](docs/b.md#c)")
        self.assertEqual(broken_links(self.root), ["README.md: docs/b.md#c"])

    def test_links_are_relative_to_their_page(self):
        self.write("[b](docs/b.md)", "docs/c.md")
        self.assertEqual(broken_links(self.root), ["docs/c.md: docs/b.md"])

    def test_a_path_that_is_gone(self):
        self.write("`core/b.h`\n```sh\ncat core/c.h\n```\n")
        self.assertEqual(missing_paths(self.root), ["README.md: core/c.h", "README.md: core/b.h"])

    def test_a_changelog_names_what_was(self):
        self.write("| `core/old.h` | `core/gone.h` |\n- Split: `core/b.h`.\n- New: `core/c.h`\n", "CHANGELOG.md")
        self.assertEqual(missing_paths(self.root), ["CHANGELOG.md: core/gone.h", "CHANGELOG.md: core/c.h"])


if __name__ == "__main__":
    unittest.main()
