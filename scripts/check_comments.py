#!/usr/bin/env python3
"""Comments whose last word was left alone on a line of its own.

    scripts/check_comments.py [--mend] [FILE_OR_FOLDER...]    default: the sources of this repository

A finding is a // or # comment line of one word after a comment line that is full, that is, one that could not have
taken the word as well: shorten the sentence by a word, or break it where it breathes. Prints "file:line: word" and
ends with 1 where there is one. --mend moves words down from the full line, from its last punctuation on; read what
comes of it.
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


def mended(text, mark):
    """The text without findings: lines keep their number."""
    lines = text.split("\n")
    while True:
        found = findings("\n".join(lines), mark)
        if not found:
            return "\n".join(lines)
        at, word = found[0][0] - 1, found[0][1]
        words = lines[at - 1].rstrip().split(" ")
        # Where it breathes in the last third of the line, else three words.
        ends = [k for k in range(1, len(words) - 1) if words[k][-1:] in ",;:." and len(" ".join(words[:k + 1])) > 70]
        cut = ends[-1] + 1 if ends else len(words) - 3
        lines[at - 1] = " ".join(words[:cut])
        lines[at] = lines[at][:lines[at].index(word)] + " ".join(words[cut:] + [word])


def sources(paths):
    for path in paths:
        path = pathlib.Path(path)
        inside = sorted(path.rglob("*")) if path.is_dir() else [path]
        for file in inside:
            if file.is_file() and file.suffix in MARKS and not {"node_modules", "build"} & set(file.parts):
                yield file


def main(arguments):
    mend = "--mend" in arguments
    arguments = [argument for argument in arguments if argument != "--mend"]
    root = pathlib.Path(__file__).resolve().parent.parent
    paths = arguments or [root / folder for folder in FOLDERS]
    files = list(sources(paths))
    if not files:
        sys.exit("check_comments: no sources in " + " ".join(map(str, paths)))
    count = 0
    for file in files:
        if mend:
            text = file.read_text(encoding="utf-8")
            if findings(text, MARKS[file.suffix]):
                file.write_text(mended(text, MARKS[file.suffix]), encoding="utf-8")
        for number, word in findings(file.read_text(encoding="utf-8"), MARKS[file.suffix]):
            shown = file.relative_to(root) if file.is_relative_to(root) else file
            print(f"{shown}:{number}: '{word}' stands alone")
            count += 1
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
