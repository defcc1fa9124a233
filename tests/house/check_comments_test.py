"""scripts/check_comments.py on comments that it must and must not find."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "scripts/check_comments.py"
sys.path.insert(0, str(SCRIPT.parent))
import check_comments  # noqa: E402

FULL = "// " + "x" * 113 + " y"  # 118 columns: no room for a word of two letters and its blank


def found(*lines, mark="//"):
    return check_comments.findings("\n".join(lines) + "\n", mark)


class OneWordAlone(unittest.TestCase):
    def test_after_a_full_line_is_found(self):
        self.assertEqual(found(FULL, "// it."), [(2, "it.")])

    def test_to_the_column(self):
        room_for_three = FULL[:-1]  # "..x " and a word of two letters make 119
        self.assertEqual(len(FULL), 118)
        self.assertEqual(found(FULL, "// z"), [])  # 118 + 1 + 1 = 120
        self.assertEqual(found(FULL, "// zz"), [(2, "zz")])  # 121
        self.assertEqual(found(room_for_three.rstrip(), "// abc"), [])

    def test_indented_and_behind_code(self):
        self.assertEqual(found("  " + FULL[:-2] + "yy", "  // it."), [(2, "it.")])
        code = "  int x = 0;  // " + "w" * 102
        self.assertEqual(found(code, " " * 14 + "// it."), [(2, "it.")])
        self.assertEqual(found(code, "  // another comment", "  int y = 0;  // it."), [])

    def test_two_words_are_a_line(self):
        self.assertEqual(found(FULL, "// of it."), [])

    def test_the_first_line_of_a_comment_is_not_left_over(self):
        self.assertEqual(found("int x = 0;", "// it."), [])
        self.assertEqual(found(FULL, "//", "// it."), [])
        self.assertEqual(found(FULL, "", "// it."), [])

    def test_at_another_indentation_another_comment_begins(self):
        self.assertEqual(found(FULL, "    // it."), [])

    def test_a_heading_of_what_is_indented_below_it(self):
        self.assertEqual(found(FULL, "// recordings:", "//   - one"), [])
        self.assertEqual(found(FULL, "// recordings:", "// one"), [(2, "recordings:")])

    def test_a_mark_in_a_string_is_no_comment(self):
        self.assertEqual(found('"' + FULL[1:], '"// it."'), [])

    def test_other_marks(self):
        self.assertEqual(found(FULL.replace("//", "#") + "y", "# it.", mark="#"), [(2, "it.")])


class Mended(unittest.TestCase):
    def test_words_move_down_from_where_the_line_breathes(self):
        line = "// " + "x" * 80 + ", and three words of it, up to" + "z" * 6
        lines = check_comments.mended(line + "\n// it.\nint x;\n", "//").split("\n")
        self.assertEqual(lines[0], "// " + "x" * 80 + ", and three words of it,")
        self.assertEqual(lines[1:], ["// up to" + "z" * 6 + " it.", "int x;", ""])

    def test_else_three_words(self):
        line = "  // " + "x" * 100 + " one two three"
        lines = check_comments.mended(line + "\n  // four.\n", "//").split("\n")
        self.assertEqual(lines[:2], ["  // " + "x" * 100, "  // one two three four."])

    def test_a_sound_text_stays(self):
        self.assertEqual(check_comments.mended(FULL + "\n// of it.\n", "//"), FULL + "\n// of it.\n")


class ThisTree(unittest.TestCase):
    def test_has_none(self):
        root = SCRIPT.parent.parent
        found = []
        for file in check_comments.sources([root / folder for folder in check_comments.FOLDERS]):
            name = str(file.relative_to(root))
            if name == "tests/house/check_comments_test.py":
                continue
            mark = check_comments.MARKS[file.suffix]
            found += [(name, *one) for one in check_comments.findings(file.read_text(encoding="utf-8"), mark)]
        self.assertEqual(found, [])


class Program(unittest.TestCase):
    def run_on(self, text, name="a.cc"):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / name).write_text(text)
            done = subprocess.run([sys.executable, SCRIPT, folder], capture_output=True, text=True)
        return done.returncode, done.stdout

    def test_says_where_and_ends_with_one(self):
        code, out = self.run_on(FULL + "\n// it.\n")
        self.assertEqual(code, 1)
        self.assertRegex(out, r"a\.cc:2: 'it\.' stands alone\n$")

    def test_a_clean_tree_ends_with_zero(self):
        self.assertEqual(self.run_on("// it.\n"), (0, ""))

    def test_a_folder_without_sources_cannot_pass(self):
        self.assertEqual(self.run_on("text", "a.md")[0], 1)


if __name__ == "__main__":
    unittest.main()
