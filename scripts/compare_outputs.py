#!/usr/bin/env python3
"""Whether two folders of results are the same, byte for byte but for how long it took.

    scripts/compare_outputs.py [--ignore KEY]... REFERENCE THIS

Compares estimate.json, loop.json, comparison.json, residuals.csv and exit_code wherever either folder has one,
without the values of "seconds" and of the ignored keys (at any depth of a JSON file). Prints a line per file with the
first difference; ends with 0 where all are the same, 1 where one differs, 2 where there is nothing to compare.
"""
import argparse
import json
import pathlib
import re
import sys

NAMES = {"estimate.json", "loop.json", "comparison.json", "residuals.csv", "exit_code"}
SECONDS = re.compile(r'("seconds": )[-+.\deE]+')


class Number(str):
    """A number as its text, so that no digit is lost."""


def parsed(text, ignored):
    def without(pairs):
        return {key: value for key, value in pairs if key not in ignored}

    return json.loads(text, object_pairs_hook=without, parse_float=Number, parse_int=Number, parse_constant=Number)


def first_difference(a, b, path=""):
    """"path: a | b" of the first place where two JSON values differ, None where they are the same."""
    if isinstance(a, dict) and isinstance(b, dict):
        if list(a) != list(b):
            lacking = [key for key in a if key not in b] + [key for key in b if key not in a]
            return f"{path}: " + (f"'{lacking[0]}' is in one only" if lacking else "keys in another order")
        for key in a:
            found = first_difference(a[key], b[key], f"{path}.{key}" if path else key)
            if found:
                return found
        return None
    if isinstance(a, list) and isinstance(b, list):
        for k, (one, other) in enumerate(zip(a, b)):
            found = first_difference(one, other, f"{path}[{k}]")
            if found:
                return found
        return f"{path}: {len(a)} | {len(b)} entries" if len(a) != len(b) else None
    return None if type(a) is type(b) and a == b else f"{path}: {short(a)} | {short(b)}"


def short(value):
    text = json.dumps(value) if not isinstance(value, Number) else value
    return text if len(text) <= 60 else text[:57] + "..."


def line_difference(a, b):
    one, other = a.splitlines(), b.splitlines()
    for k, (x, y) in enumerate(zip(one, other), 1):
        if x != y:
            fields = [(p, q) for p, q in zip(x.split(","), y.split(",")) if p != q]
            return f"line {k}: " + (" | ".join(fields[0]) if fields else f"{short(x)} | {short(y)}")
    return f"{len(one)} | {len(other)} lines" if len(one) != len(other) else "the end of the last line"


def difference(reference, this, ignored):
    """None where the two files are the same, else what is different first."""
    if not reference.exists():
        return "is not in the reference"
    if not this.exists():
        return "is in the reference only"
    a, b = reference.read_text(encoding="utf-8"), this.read_text(encoding="utf-8")
    if reference.suffix == ".json":
        a, b = SECONDS.sub(r"\g<1>0", a), SECONDS.sub(r"\g<1>0", b)
    if a == b:
        return None
    if reference.suffix != ".json":
        return line_difference(a, b)
    found = first_difference(parsed(a, ignored), parsed(b, ignored))
    if found or ignored:
        return found
    return "the same values, other " + line_difference(a, b)


def compare(reference, this, ignored):
    """[(file, difference or None)] by name."""
    files = {f.relative_to(folder) for folder in (reference, this) for f in folder.rglob("*") if f.name in NAMES}
    return [(str(f), difference(reference / f, this / f, ignored)) for f in sorted(files)]


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--ignore", metavar="KEY", action="append", default=[])
    parser.add_argument("reference", type=pathlib.Path)
    parser.add_argument("this", type=pathlib.Path)
    options = parser.parse_args(arguments)
    results = compare(options.reference, options.this, set(options.ignore))
    if not results:
        print(f"nothing to compare in {options.reference} and {options.this}", file=sys.stderr)
        return 2
    width = max(len(name) for name, _ in results)
    for name, found in results:
        print(f"{name:{width}}  " + ("same" if found is None else f"differs  {found}"))
    differing = sum(found is not None for _, found in results)
    print(f"{len(results) - differing} same, {differing} different")
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
