#!/usr/bin/env python3
# Copyright (c) 2026 The pcs authors
# SPDX-License-Identifier: BSL-1.0
"""Prints which lines and branches of include/pcs the tests of the preset `coverage` have executed.

    ctest --preset coverage -LE long
    test/coverage.py --build build/coverage [--depth 1] [--errors] [--lines FOLDER] [--json FILE]

A line counts once, however many instances of a template contain it: it is covered if one of them
has executed it. A branch is a way out of a condition; those that only an exception takes are left
out, because nearly every call has one. Inline functions and templates that no test uses are not
in the object files: gcov does not know their lines, and headers without any line are listed.

Needs Python 3 without further packages, and the gcov of the compiler.
"""

import argparse
import collections
import concurrent.futures
import json
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
HEADERS = ROOT / "include" / "pcs"
ERROR = re.compile(r"\b(throw|Invalid_input|IO_error|fail(_\w+)?)\b\s*[(;\w]")

# Of a line with more branches, the instances of a template are not told apart: two ways count.
MOST_BRANCHES = 12


class Header:
    """What was executed of one header."""

    def __init__(self):
        self.lines = collections.Counter()  # line -> number of executions
        self.branches = {}  # (line, function, number of the branch) -> taken
        self.targets = collections.defaultdict(set)  # line -> CMake targets that have executed it

    def add(self, data, target):
        starts = {f["name"]: (f["start_line"], f["start_column"]) for f in data["functions"]}
        for entry in data["lines"]:
            line = entry["line_number"]
            self.lines[line] += entry["count"]
            if entry["count"]:
                self.targets[line].add(target)
            # instances of one template begin at the same place
            place = starts.get(entry.get("function_name"))
            usual = [branch for branch in entry["branches"] if not branch["throw"]]
            is_of_many = len(usual) > MOST_BRANCHES
            for number, branch in enumerate(usual):
                key = (line, place, branch["fallthrough"] if is_of_many else number)
                self.branches[key] = self.branches.get(key, False) or branch["count"] > 0

    def covered(self):
        return sum(count > 0 for count in self.lines.values())

    def missing(self):
        return sorted(line for line, count in self.lines.items() if not count)


def run_gcov(gcov, notes):
    """The headers of pcs in one object file, as gcov describes them."""
    data = notes.with_suffix(".gcda")
    command = [gcov, "--json-format", "--stdout", "--branch-probabilities", "--relative-only"]
    command += ["--source-prefix", str(ROOT), str(data if data.exists() else notes)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        sys.exit(f"test/coverage.py: {gcov} cannot read {notes}: {result.stderr.strip()}; "
                 "remove the file, and build the preset `coverage` again")
    files = json.loads(result.stdout)["files"] if result.stdout.strip() else []
    inside = []
    for file in files:
        path = pathlib.Path(file["file"])
        path = path if path.is_absolute() else ROOT / path
        path = pathlib.Path(os.path.normpath(path))
        if HEADERS in path.parents:
            inside.append((str(path.relative_to(HEADERS)), file))
    return inside


def target_of(notes):
    """The CMake target of an object file."""
    for part in notes.parts:
        if part.endswith(".dir"):
            return part[: -len(".dir")]
    return "unknown"


def read_headers(build, gcov):
    notes = sorted(build.rglob("*.gcno"))
    if not notes:
        sys.exit(f"test/coverage.py: {build} has no .gcno file; build the preset `coverage` first")
    headers = collections.defaultdict(Header)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for path, files in zip(notes, pool.map(lambda note: run_gcov(gcov, note), notes)):
            for name, data in files:
                headers[name].add(data, target_of(path))
    return headers


def percent(part, whole):
    return f"{100 * part / whole:.1f} %" if whole else "-"


def print_table(headers, depth):
    rows = collections.defaultdict(lambda: [0, 0, 0, 0, 0])
    for name, header in headers.items():
        folders = name.split("/")[:-1][:depth]
        for key in ("/".join(folders) or "(top)", "all"):
            row = rows[key]
            row[0] += 1
            row[1] += len(header.lines)
            row[2] += header.covered()
            row[3] += len(header.branches)
            row[4] += sum(header.branches.values())
    print("| folder | headers | lines | covered | share | branches | taken | share |")
    print("|---|---|---|---|---|---|---|---|")
    for key in sorted(rows, key=lambda k: (k == "all", k)):
        count, lines, covered, branches, taken = rows[key]
        print(f"| {key} | {count} | {lines} | {covered} | {percent(covered, lines)} "
              f"| {branches} | {taken} | {percent(taken, branches)} |")


def source_of(name):
    """The lines of a header without comments, so that a word in a comment is no statement."""
    text = (HEADERS / name).read_text(encoding="utf-8")
    text = re.sub(r"/\*.*?\*/", lambda m: "\n" * m.group().count("\n"), text, flags=re.DOTALL)
    return [re.sub(r"//.*", "", line) for line in text.split("\n")]


def print_errors(headers):
    """Lines that report an error, and that no test has executed."""
    count = 0
    for name in sorted(headers):
        missing = headers[name].missing()
        text = source_of(name) if missing else []
        for line in missing:
            if ERROR.search(text[line - 1]):
                count += 1
                print(f"{name}:{line}: {text[line - 1].strip()}")
    print(f"{count} lines that report errors were not executed")


def ranges(numbers):
    """[1, 2, 3, 7] as 1-3 7."""
    groups = []
    for number in numbers:
        if groups and number == groups[-1][1] + 1:
            groups[-1][1] = number
        else:
            groups.append([number, number])
    return " ".join(str(a) if a == b else f"{a}-{b}" for a, b in groups)


def print_missing(headers, folder):
    for name in sorted(headers):
        missing = headers[name].missing()
        if name.startswith(folder) and missing:
            share = percent(headers[name].covered(), len(headers[name].lines))
            print(f"{name}: {share}; not executed: {ranges(missing)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build" / "coverage",
                        help="the build folder of the preset `coverage`")
    parser.add_argument("--gcov", default="gcov", help="the gcov of the compiler")
    parser.add_argument("--depth", type=int, default=1, help="levels of folders in the table")
    parser.add_argument("--errors", action="store_true",
                        help="list the lines that report errors and were not executed")
    parser.add_argument("--lines", metavar="FOLDER",
                        help="list the lines of a folder that were not executed")
    parser.add_argument("--json", type=pathlib.Path, metavar="FILE",
                        help="write, for each line executed, the CMake targets that did")
    arguments = parser.parse_args()
    headers = read_headers(arguments.build, arguments.gcov)
    print_table(headers, arguments.depth)
    unknown = sorted(str(path.relative_to(HEADERS)) for path in HEADERS.rglob("*.h")
                     if str(path.relative_to(HEADERS)) not in headers)
    print(f"\n{len(unknown)} headers have no line in any object file: {' '.join(unknown)}")
    if arguments.errors:
        print()
        print_errors(headers)
    if arguments.lines is not None:
        print()
        print_missing(headers, arguments.lines)
    if arguments.json:
        table = {name: {line: sorted(targets) for line, targets in header.targets.items()}
                 for name, header in headers.items()}
        arguments.json.write_text(json.dumps(table), encoding="utf-8")


if __name__ == "__main__":
    main()
