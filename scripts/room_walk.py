#!/usr/bin/env python3
"""How often the way of a datum through the sources comes back to a room that it had left.

    scripts/room_walk.py [--root DIR] [--start CloseLoop] [--in solvers/loop/close_loop.cc] [--flat] [--rooms]

Walks the static call tree of a function, depth first, calls in the order in which they stand. A room is a folder
below core/ or solvers/ (and residuals/ as a whole); with --flat every pair of a source and its header that lies in
core/ or solvers/ itself is one, for trees from before there were rooms in them. Every function is walked once, at its
first call. A call leaves the room of the caller for that of the called one, the end of the call comes back. Counted
are the places, a line and a room, from which a call enters a room that was left before. Not counted are the ends of
calls, calls of what was walked already, calls of methods of one statement, since to read a value is no way, and calls
into core/base and core/report, which are tools.

At commit e14d542 there are 47 (--flat --in solvers/close_loop.cc).

Sources are read without a compiler: a function is what has a name, parentheses and a body; a call is a name before a
parenthesis that is a function's, preferably in the same file, else by Class::name, else where one room alone has it.
"""
import argparse
import collections
import pathlib
import re
import sys

FOLDERS = ("core", "residuals", "solvers")
TOOLS = {"core/base", "core/report"}
KEYWORDS = set("if for while switch return catch sizeof decltype static_cast const_cast reinterpret_cast dynamic_cast "
               "assert alignof noexcept else do new delete throw operator defined static_assert void".split())
NAME = r"(?:[A-Za-z_]\w*::)*~?[A-Za-z_]\w*"
BODY = re.compile(r"\s*(?:const\b|noexcept\b|override\b|final\b|->\s*[\w:<>,&* ]+|\s)*"
                  r"(?::(?!:)[^;]*?[)}]\s*)?\{")
HEAD = re.compile(r"(?<![\w:>.])(" + NAME + r")\s*\(")

Function = collections.namedtuple("Function", "name file line begin end")


def blank(text):
    """Comments, strings and preprocessor lines as blanks: lines and columns stay."""
    pattern = re.compile(
        r"""//[^\n]*|/\*.*?\*/|R"\(.*?\)"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+'|^[ \t]*\#(?:\\\n|[^\n])*""",
        re.S | re.M)
    return pattern.sub(lambda m: re.sub(r"[^\n]", " ", m[0]), text)


def closing(text, at, opening, close):
    """Behind the mark that closes the one at `at`."""
    depth = 0
    for k in range(at, len(text)):
        if text[k] == opening:
            depth += 1
        elif text[k] == close:
            depth -= 1
            if depth == 0:
                return k + 1
    return len(text)


def functions(text, file):
    """Definitions in blanked text, those of classes by Class::name."""
    found = []
    classes = [(m[1], m.end() - 1, closing(text, m.end() - 1, "{", "}"))
               for m in re.finditer(r"\b(?:class|struct)\s+([A-Za-z_]\w*)[^;{}()]*\{", text)]
    at = 0
    while True:
        match = HEAD.search(text, at)
        if not match:
            return found
        at = match.end()
        if match[1] in KEYWORDS:
            continue
        behind = closing(text, match.end() - 1, "(", ")")
        # What may stand between parameters and body: qualifiers, a return type, initialisers of members.
        body = BODY.match(text, behind)
        if not body:
            continue
        end = closing(text, body.end() - 1, "{", "}")
        name = match[1]
        inside = [c for c in classes if c[1] < match.start() < c[2]]
        if inside and "::" not in name:
            name = inside[-1][0] + "::" + name
        found.append(Function(name, file, text.count("\n", 0, match.start()) + 1, body.end(), end))
        at = end


class Sources:
    def __init__(self, root, flat=False):
        self.root, self.flat = pathlib.Path(root), flat
        self.texts, self.all = {}, []
        for folder in FOLDERS:
            for path in sorted((self.root / folder).rglob("*")):
                if path.suffix in (".cc", ".h") and "node_modules" not in path.parts:
                    file = str(path.relative_to(self.root))
                    self.texts[file] = blank(path.read_text(encoding="utf-8"))
                    self.all += functions(self.texts[file], file)
        self.by_name = collections.defaultdict(list)
        for function in self.all:
            parts = function.name.split("::")
            if len(parts) == 1 or not self.reads_a_value(function):
                self.by_name[parts[-1]].append(function)

    def reads_a_value(self, function):
        return self.texts[function.file].count(";", function.begin, function.end) <= 1

    def room(self, file):
        parts = file.split("/")
        if len(parts) > 2:
            return "/".join(parts[:2])
        return file.rsplit(".", 1)[0] if self.flat else parts[0]

    def resolve(self, called, file):
        """The functions that a call may mean: overloads in one file are all taken for one."""
        parts = called.split("::")
        candidates = self.by_name.get(parts[-1], [])
        if len(parts) > 1:
            candidates = [f for f in candidates if f.name.split("::")[-2:-1] == parts[-2:-1] or
                          "::" not in f.name and parts[-2] == "idim"]
        own = [f for f in candidates if f.file.rsplit(".", 1)[0] == file.rsplit(".", 1)[0]]
        if own:
            return own
        # Without a compiler a name that several rooms have is nobody's.
        return candidates if len({self.room(f.file) for f in candidates}) == 1 else []

    def calls(self, function):
        """(functions called, line) in the order of the text."""
        text = self.texts[function.file]
        call = re.compile(r"(?<![\w:~])(" + NAME + r")(?:<[\w:, ]*>)?\s*[({]|&(" + NAME + r")\b")
        for match in call.finditer(text, function.begin, function.end):
            name = match[1] or match[2]
            if name in KEYWORDS:
                continue
            found = [f for f in self.resolve(name, function.file) if f != function]
            if found:
                yield found, text.count("\n", 0, match.start()) + 1


Entry = collections.namedtuple("Entry", "room file line caller callee")


def walk(sources, start):
    """(entries into rooms already left, rooms in the order of the walk)."""
    entries, order, walked, left, counted = [], [], set(), set(), set()
    order.append(sources.room(start.file))

    def visit(function):
        walked.add(function)
        here = sources.room(function.file)
        for found, line in sources.calls(function):
            fresh = [f for f in found if f not in walked]
            for callee in fresh:
                if callee in walked:
                    continue
                room = sources.room(callee.file)
                if room in TOOLS:
                    continue
                if room != here:
                    left.add(here)
                    place = (function.file, line, room)
                    if room in left and place not in counted:
                        counted.add(place)
                        entries.append(Entry(room, function.file, line, function.name, callee.name))
                    order.append(room)
                visit(callee)
                if room != here:
                    left.add(room)

    visit(start)
    return entries, order


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", default=pathlib.Path(__file__).resolve().parent.parent)
    parser.add_argument("--start", default="CloseLoop")
    parser.add_argument("--in", dest="file", default="solvers/loop/close_loop.cc")
    parser.add_argument("--flat", action="store_true")
    parser.add_argument("--rooms", action="store_true", help="also the rooms in the order in which they are entered")
    options = parser.parse_args(arguments)
    sys.setrecursionlimit(10000)
    sources = Sources(options.root, options.flat)
    starts = [f for f in sources.by_name[options.start.split("::")[-1]] if f.file == options.file]
    if not starts:
        print(f"room_walk: there is no function {options.start} in {options.file}", file=sys.stderr)
        return 2
    entries, order = walk(sources, starts[-1])
    if options.rooms:
        print(" ".join(order))
    for entry in entries:
        print(f"{entry.file}:{entry.line}: {entry.caller} enters {entry.room} again by {entry.callee}")
    print(f"{len(entries)} entries to a room already left, {len(set(order))} rooms")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
