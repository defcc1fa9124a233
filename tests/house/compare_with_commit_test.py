"""scripts/compare_with_commit.sh and scripts/compare_outputs.py, on programs made for it that differ in one place."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "scripts/compare_with_commit.sh"
sys.path.insert(0, str(ROOT / "scripts"))
import compare_outputs  # noqa: E402

# A program writes what a sibling file "results" says, and takes a time of its own.
PROGRAM = """#!/usr/bin/env bash
for word in "$@"; do
  case $word in
    --output=*) output=${{word#--output=}} ;;
    --threads=*) threads=${{word#--threads=}} ;;
    --estimator=*) estimator=${{word#--estimator=}} ;;
  esac
done
mkdir -p "$output"
echo '{{"value": {value}, "list": [1, {{"deep": {deep}}}], "seconds": '$RANDOM.5'}}' >"$output/{file}"
{more}
exit {code}
"""
FILES = {"idim_identify": "estimate.json", "idim_compare": "comparison.json", "idim_close_loop": "loop.json"}


@unittest.skipUnless((ROOT / ".git").exists(), "not a checkout of git")
class Script(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)
        for tree in ("reference", "this"):
            for program in FILES:
                self.make(tree, program)

    def tearDown(self):
        self.folder.cleanup()

    def make(self, tree, program, value="0.1", deep="3", code=0, more=""):
        path = self.root / tree / "apps" / program
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(PROGRAM.format(value=value, deep=deep, code=code, more=more, file=FILES[program]))
        path.chmod(0o755)

    def run_script(self, *options, commit="HEAD", studies=("datasets/ur10e/study.yaml",)):
        command = [SCRIPT, "--reference-build", self.root / "reference", "--build", self.root / "this",
                   "--output", self.root / "output", *options, commit, *studies]
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
        return done.returncode, done.stdout, done.stderr

    def line(self, out, file):
        return next(line for line in out.splitlines() if line.startswith(file + " "))

    def test_the_same_programs(self):
        code, out, err = self.run_script()
        self.assertEqual((code, err), (0, ""))
        # Two estimators, two programs with one thread and two; a result and an exit code each.
        self.assertEqual(len(out.splitlines()), 12 + 1)
        self.assertEqual(out.splitlines()[-1], "12 same, 0 different")
        self.assertIn("same", self.line(out, "ur10e/close_loop_threads_2/loop.json"))

    def test_quick_is_without_the_loops(self):
        self.make("this", "idim_close_loop", value="9")
        code, out, _ = self.run_script("--quick")
        self.assertEqual((code, out.splitlines()[-1]), (0, "8 same, 0 different"))

    def test_a_last_digit(self):
        self.make("this", "idim_identify", value="0.10000000000000001")
        code, out, _ = self.run_script("--quick")
        self.assertEqual(code, 1)
        self.assertIn("differs  value: 0.1 | 0.10000000000000001", self.line(out, "ur10e/identify_wls/estimate.json"))
        self.assertEqual(out.splitlines()[-1], "6 same, 2 different")

    def test_in_the_loop(self):
        self.make("this", "idim_close_loop", deep="4")
        code, out, _ = self.run_script()
        self.assertEqual(code, 1)
        self.assertIn("differs  list[1].deep: 3 | 4", self.line(out, "ur10e/close_loop_threads_1/loop.json"))

    def test_an_ignored_key(self):
        self.make("this", "idim_close_loop", deep="4")
        self.assertEqual(self.run_script("--ignore", "deep")[0], 0)
        self.assertEqual(self.run_script("--ignore", "value")[0], 1)

    def test_an_exit_code(self):
        self.make("this", "idim_compare", code=2)
        code, out, _ = self.run_script("--quick")
        self.assertEqual(code, 1)
        self.assertIn("differs", self.line(out, "ur10e/compare_threads_1/exit_code"))

    def test_a_file_that_one_does_not_write(self):
        self.make("reference", "idim_identify", more='echo a,b >"$output/residuals.csv"')
        code, out, _ = self.run_script("--quick")
        self.assertEqual(code, 1)
        self.assertIn("differs  is in the reference only", self.line(out, "ur10e/identify_eiv/residuals.csv"))

    def test_a_line_of_a_table(self):
        self.make("reference", "idim_identify", more='printf "a,b\\n1,2\\n" >"$output/residuals.csv"')
        self.make("this", "idim_identify", more='printf "a,b\\n1,3\\n" >"$output/residuals.csv"')
        code, out, _ = self.run_script("--quick")
        self.assertEqual(code, 1)
        self.assertIn("differs  line 2: 2 | 3", self.line(out, "ur10e/identify_eiv/residuals.csv"))

    def test_one_thread_and_two(self):
        threads = """[ "$threads" = 1 ] || sed -i 's/0.1/0.2/' "$output/comparison.json" """
        for tree in ("reference", "this"):
            self.make(tree, "idim_compare", more=threads)
        code, out, _ = self.run_script("--quick")
        self.assertEqual(code, 1)
        self.assertIn("one thread and two differ: ur10e/compare_threads_1", out)

    def test_what_cannot_be_told(self):
        self.assertEqual(self.run_script(commit="no_such_commit")[0], 2)
        self.assertEqual(self.run_script(studies=("nowhere.yaml",))[0], 2)
        self.assertEqual(self.run_script("--no_such_option")[0], 2)
        (self.root / "this/apps/idim_compare").unlink()
        self.assertEqual(self.run_script()[0], 2)

    def test_results_of_before_do_not_count(self):
        self.make("reference", "idim_identify", more='echo a,b >"$output/residuals.csv"')
        self.run_script("--quick")
        self.make("reference", "idim_identify")
        self.assertEqual(self.run_script("--quick")[0], 0)


class Outputs(unittest.TestCase):
    def compare(self, a, b, ignored=()):
        with tempfile.TemporaryDirectory() as folder:
            one, other = pathlib.Path(folder) / "a.json", pathlib.Path(folder) / "b.json"
            one.write_text(a), other.write_text(b)
            return compare_outputs.difference(one, other, set(ignored))

    def test_seconds_may_differ_and_nothing_else(self):
        self.assertIsNone(self.compare('{"seconds": 1.5e-3}', '{"seconds": 2}'))
        self.assertIsNotNone(self.compare('{"milliseconds": 1}', '{"milliseconds": 2}'))

    def test_bytes_count(self):
        self.assertIn("the same values", self.compare('{"a": 1}', '{"a":  1}'))
        self.assertIsNotNone(self.compare('{"a": 1.0}', '{"a": 1}'))
        self.assertIsNotNone(self.compare('{"a": "1"}', '{"a": 1}'))

    def test_order_and_length_count(self):
        self.assertIn("another order", self.compare('{"a": 1, "b": 2}', '{"b": 2, "a": 1}'))
        self.assertEqual(self.compare('{"a": [1, 2]}', '{"a": [1]}'), "a: 2 | 1 entries")
        self.assertIn("'b' is in one only", self.compare('{"a": 1, "b": 2}', '{"a": 1}'))

    def test_an_ignored_key_at_any_depth(self):
        a, b = {"x": [{"k": 1, "y": 2}]}, {"x": [{"y": 2}]}
        self.assertIsNone(self.compare(json.dumps(a), json.dumps(b), ["k"]))

    def test_nothing_to_compare_cannot_pass(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(compare_outputs.main([folder, folder]), 2)


if __name__ == "__main__":
    unittest.main()
