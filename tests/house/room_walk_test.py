"""scripts/room_walk.py on a small tree whose way is known."""
import pathlib
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
import room_walk  # noqa: E402

TREE = {
    "core/base/text.h": "inline int Text() { return 1; }\n",
    "core/model/data.h": "int Read();\nint Check();\nstruct Data {\n  int size() const { return 2; }\n"
                         "  int Size() const {\n    Count();\n    return 2;\n  }\n};\n",
    "core/model/data.cc": "#include \"core/model/data.h\"\n"
                          "int Count() { return 0; }\n"
                          "int Check() { return Text(); }\n"
                          "int Read() { return Check(); }\n"
                          "int Late() { return 4; }\n",
    "solvers/bundle/fit.cc": "// Late() is only spoken of here, as is \"Late()\" below.\n"
                             "namespace { int Weigh(int x) { return x; } }\n"
                             "int Fit() {\n  const char* name = \"Late()\";\n  return Weigh(Late());\n}\n",
    "solvers/loop/close_loop.cc": "int Score(int x) { return x; }\n"
                                  "int CloseLoop() {\n  Read();\n  Fit();\n  Fit();\n  return Score(Check());\n}\n",
}


class RoomWalk(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name)
        for name, text in TREE.items():
            self.write(name, text)

    def tearDown(self):
        self.folder.cleanup()

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    def walk(self, flat=False, file="solvers/loop/close_loop.cc"):
        sources = room_walk.Sources(self.root, flat)
        start = next(f for f in sources.by_name["CloseLoop"] if f.file == file)
        return room_walk.walk(sources, start)

    def test_the_way_and_its_return(self):
        entries, order = self.walk()
        # Read, then Fit, which calls Late of the room that Read was in. What is called again adds nothing.
        self.assertEqual(order, ["solvers/loop", "core/model", "solvers/bundle", "core/model"])
        self.assertEqual([(e.room, e.file, e.line, e.caller, e.callee) for e in entries],
                         [("core/model", "solvers/bundle/fit.cc", 5, "Fit", "Late")])

    def test_a_straight_way_has_none(self):
        self.write("solvers/bundle/fit.cc", "int Fit() { return 0; }\n")
        self.assertEqual(self.walk()[0], [])

    def test_a_place_counts_once(self):
        self.write("core/model/more.cc", "int Later() { return 5; }\n")
        self.write("solvers/bundle/fit.cc", "int Fit() { return Late() + Later(); }\n")
        self.assertEqual([e.callee for e in self.walk()[0]], ["Late"])
        self.write("solvers/bundle/fit.cc", "int Fit() {\n  return Late() +\n         Later();\n}\n")
        self.assertEqual([(e.callee, e.line) for e in self.walk()[0]], [("Late", 2), ("Later", 3)])

    def test_tools_are_not_on_the_way(self):
        self.assertNotIn("core/base", self.walk()[1])

    def test_a_flat_folder_has_a_room_a_file(self):
        self.write("solvers/close_loop.cc", "int CloseLoop() {\n  One();\n  Two();\n}\n")
        self.write("solvers/one.cc", "int One() { return 1; }\nint Rest() { return 2; }\n")
        self.write("solvers/two.cc", "int Two() { return Rest(); }\n")
        entries, order = self.walk(flat=True, file="solvers/close_loop.cc")
        self.assertEqual(order, ["solvers/close_loop", "solvers/one", "solvers/two", "solvers/one"])
        self.assertEqual(len(entries), 1)
        self.assertEqual(self.walk(flat=False, file="solvers/close_loop.cc")[0], [])

    def test_methods_are_found(self):
        self.write("solvers/bundle/fit.cc", "int Fit() {\n  Data data;\n  return data.Size();\n}\n")
        self.assertEqual([e.callee for e in self.walk()[0]], ["Data::Size"])

    def test_to_read_a_value_is_no_way(self):
        self.write("solvers/bundle/fit.cc", "int Fit() {\n  Data data;\n  return data.size();\n}\n")
        self.assertEqual(self.walk()[0], [])

    def test_this_tree(self):
        sources = room_walk.Sources(ROOT)
        start = next(f for f in sources.by_name["CloseLoop"] if f.file == "solvers/loop/close_loop.cc")
        entries, order = room_walk.walk(sources, start)
        for room in ("core/model", "solvers/bundle", "core/statistics", "solvers/loop"):
            self.assertIn(room, order)
        # No more than there were before there were rooms.
        self.assertLessEqual(len(entries), 47)


if __name__ == "__main__":
    unittest.main()
