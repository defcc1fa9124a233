#!/usr/bin/env python3
"""Comments whose last word was left alone on a line of its own.

    scripts/check_comments.py [FILE_OR_FOLDER...]    default: the sources of this repository

A finding is a // or # comment line of one word after a comment line that is full, that is, one that could not have
taken the word as well: shorten the sentence by a word, or break it where it breathes. Prints "file:line: word" and
ends with 1 where there is one.
"""
import pathlib
import re
import sys

WIDTH = 120
FOLDERS = ["core", "residuals", "solvers", "apps", "tests", "benchmarks", "scripts", "CMakeLists.txt"]
MARKS = {".h": "//", ".cc": "//", ".js": "//", ".cmake": "#", ".txt": "#", ".py": "#", ".sh": "#"}
# What is before a comment on its line, the mark, the blanks behind it, the text.
LINE = r"^(?P<before>{code})(?P<mark>{mark})(?P<blanks> +)(?P<text>\S.*?)\s*$"


def comment_of(line, mark):
    """(column of the mark, is there code before it, blanks after the mark, text), or None."""
    match = re.match(LINE.format(code=r"\s*|.*?\s{1,}", mark=mark), line)
    if not match:
        return None
    before = match["before"]
    if before.count('"') % 2:
        return None
    return len(before), bool(before.strip()), len(match["blanks"]), match["text"]


def findings(text, mark):
    """(line number, word) of each comment line that one word has to itself after a full line."""
    lines = text.splitlines()
    comments = [comment_of(line, mark) for line in lines] + [None]
    found = []
    for k in range(1, len(lines)):
        previous, comment, following = comments[k - 1], comments[k], comments[k + 1]
        if not comment or not previous or comment[1] or comment[0] != previous[0]:
            continue
        _, _, blanks, words = comment
        full = len(lines[k - 1].rstrip()) + 1 + len(words) > WIDTH
        heading = words.endswith(":") and following and following[2] > blanks
        if " " not in words and full and not heading:
            found.append((k + 1, words))
    return found


def sources(paths):
    for path in paths:
        path = pathlib.Path(path)
        inside = sorted(path.rglob("*")) if path.is_dir() else [path]
        for file in inside:
            if file.is_file() and file.suffix in MARKS and not {"node_modules", "build"} & set(file.parts):
                yield file


def main(arguments):
    root = pathlib.Path(__file__).resolve().parent.parent
    paths = arguments or [root / folder for folder in FOLDERS]
    files = list(sources(paths))
    if not files:
        sys.exit("check_comments: no sources in " + " ".join(map(str, paths)))
    count = 0
    for file in files:
        for number, word in findings(file.read_text(encoding="utf-8"), MARKS[file.suffix]):
            shown = file.relative_to(root) if file.is_relative_to(root) else file
            print(f"{shown}:{number}: '{word}' stands alone")
            count += 1
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
