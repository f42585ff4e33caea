#!/usr/bin/env python3
# Copyright (c) 2026 The pcs authors
# SPDX-License-Identifier: BSL-1.0
"""Changes single lines of include/pcs, and reports which changes the tests notice.

    test/coverage.py --build build/coverage --json build/covered.json
    test/mutation.py --covered build/covered.json --count 400 --tests 14 --seed 1

A mutant has one change in a line that the tests execute: a comparison is inverted, + and - are
exchanged, a constant is one larger, a condition is negated, or a statement is removed. The headers
in the folder --work have all mutants, each behind a switch `::pcs_mutant(k)` that the environment
variable PCS_MUTANT turns on; include/pcs is not touched. So a test source is compiled once, without
optimisation, as a program of its own, and run once for each mutant that it executes. Changes that
do not compile in this form are left out.

Test sources are drawn from the folders of test/ in turn, and lines from the headers that these
sources include, from the folders of include/pcs in turn. A mutant is `noticed` if one program fails
or takes ten times as long. What they do not notice is judged by all other test sources that include
the header directly, unless they are too large (--headers). If these do not notice it either, it
`survives`; programs that reach the header by others might notice it still.

Needs Python 3 without further packages, and the packages that the tests need.
"""

import argparse
import itertools
import json
import os
import pathlib
import random
import re
import resource
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
FLAGS = ["-std=c++17", "-O0", "-w", "-DCGAL_DEBUG", "-DBOOST_TEST_DYN_LINK",
         "-DBOOST_TEST_MODULE=mutant", "-DCGAL_LINKED_WITH_TBB", "-DPCS_WITH_TBB=1",
         "-DCGAL_EIGEN3_ENABLED=1", "-isystem", "/usr/include/eigen3", f"-I{ROOT / 'test'}"]
LIBRARIES = ["-lboost_unit_test_framework", "-ltbb", "-ltbbmalloc", "-lgmp", "-lmpfr", "-lpthread"]
MEMORY = 6 << 30  # of a test [bytes]; a mutant may allocate without end

NO_CODE = re.compile(r"^\s*(#|//|/?\*|template\b|using\b|namespace\b|static_assert\b|struct\b|"
                     r"class\b|friend\b|public:|private:|CGAL_|BOOST_)")


SWITCH = """#pragma once
#include <cstdio>
#include <cstdlib>
inline const int pcs_chosen = std::getenv("PCS_MUTANT") ? std::atoi(std::getenv("PCS_MUTANT")) : -1;
inline bool pcs_is_reached[COUNT] = {};
struct Pcs_reached {
  ~Pcs_reached() {
    if (const char* name = std::getenv("PCS_REACHED"))
      if (std::FILE* file = std::fopen(name, "w")) {
        for (int k = 0; k < COUNT; ++k)
          if (pcs_is_reached[k])
            std::fprintf(file, "%d\\n", k);
        std::fclose(file);
      }
  }
};
inline Pcs_reached pcs_reached;
inline bool pcs_mutant(int k) { pcs_is_reached[k] = true; return k == pcs_chosen; }
"""

STOPS = (" && ", " || ", " ? ", " : ", ", ", " = ", "return ", ";")


def operand(text, step):
    """How many characters of an operand follow in the direction of `step`, or None."""
    depth, opening, closing = 0, "([{", ")]}"
    ahead, behind = (opening, closing) if step > 0 else (closing, opening)
    order = range(len(text)) if step > 0 else range(len(text) - 1, -1, -1)
    for i in order:
        if text[i] in ahead:
            depth += 1
        elif text[i] in behind:
            depth -= 1
        if depth < 0:
            return i if step > 0 else i + 1
        if depth == 0:
            for stop in STOPS:
                if step > 0 and text.startswith(stop, i):
                    return i
                if step < 0 and text.endswith(stop, 0, i + 1):
                    return i + 1
    return None


def comparisons(text, switch):
    for match in re.finditer(r" (<=|>=|==|!=|<|>) ", text):
        start, end = operand(text[:match.start()], -1), operand(text[match.end():], 1)
        if start is not None and end is not None:
            end += match.end()
            yield "comparison", f"{text[:start]}(({text[start:end]}) != {switch}){text[end:]}"


def signs(text, switch):
    factor = f"({switch} ? -1 : 1) * "
    for match in re.finditer(r"(?<=[\w)\]]) [-+] (?=[\w(*])", text):
        yield "sign", text[:match.end()] + factor + text[match.end():]
    match = re.match(r"^(\s*[\w.\->\[\]()*:]+ [-+]= )(.*);\s*$", text)
    if match:
        yield "sign", f"{match.group(1)}{factor}({match.group(2)});"


def constants(text, switch):
    for match in re.finditer(r"(?<![\w.\[<'])(?<!e-)(\d+(?:\.\d+)?)(?![\w.>'])", text):
        number = match.group()
        larger = str(int(number) + 1) if "." not in number else repr(float(number) + 1)
        yield "constant", (f"{text[:match.start()]}({switch} ? {larger} : {number})"
                           f"{text[match.end():]}")


def conditions(text, switch):
    match = re.match(r"^(\s*(?:\} else )?(?:if|while) \()(.*)(\)(?: \{)?\s*)$", text)
    if match and match.group(2).count("(") == match.group(2).count(")"):
        yield "condition", (f"{match.group(1)}static_cast<bool>({match.group(2)}) != {switch}"
                            f"{match.group(3)}")


def statements(lines, index, switch):
    """An assignment or a call that is one line."""
    text, before = lines[index].rstrip(), lines[index - 1].rstrip()
    is_whole = before.endswith((";", "{", "}")) and text.endswith(";")
    if is_whole and re.match(r"^\s*[\w.\->\[\]()*:]+(\s[-+*/|&]?=\s|\(|\+\+;|--;)", text) \
            and not re.match(r"^\s*(return|throw|else|for|while|do|if|break)\b", text):
        yield "statement", f"if (!{switch}) {text.strip()}"


def mutants(lines, number, k):
    """All changes of a line behind the switch `k`, as pairs of kind and new text."""
    text, switch = lines[number - 1], f"::pcs_mutant({k})"
    if NO_CODE.match(text):
        return []
    found = list(statements(lines, number - 1, switch))
    if '"' not in text and "//" not in text and "constexpr" not in text:
        for change in (comparisons, signs, constants, conditions):
            found += change(text, switch)
    return found


class Sources:
    """The test sources, the headers of pcs that they include, and how many others these include."""

    def __init__(self):
        tests = [p for p in (ROOT / "test").rglob("test_*.cpp") if "compile_fail" not in p.parts]
        self.tests = {path: self.headers_in(path) for path in sorted(tests)}
        root = ROOT / "include" / "pcs"
        self.headers = {str(p.relative_to(root)): self.headers_in(p) for p in root.rglob("*.h")}
        self.sizes = {path: self.headers_below(headers) for path, headers in self.tests.items()}

    @staticmethod
    def headers_in(path):
        return set(re.findall(r"#include <pcs/(.*)>", path.read_text(encoding="utf-8")))

    def headers_below(self, headers):
        """How many headers are included, directly or by other headers."""
        reached, last = set(headers), set(headers)
        while last:
            last = set().union(*(self.headers.get(name, set()) for name in last)) - reached
            reached |= last
        return len(reached)

    def of(self, header):
        """The test sources that include the header directly."""
        return [path for path, headers in self.tests.items() if header in headers]


def folder_of(path):
    """The first folder of a path, or the empty name."""
    return path.split("/")[0] if "/" in path else ""


def in_turn(items, folder):
    """The same items, one of each folder in turn."""
    folders = {}
    for item in items:
        folders.setdefault(folder(item), []).append(item)
    for row in itertools.zip_longest(*folders.values()):
        yield from (item for item in row if item is not None)


def limit_memory():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


class Mutants:
    """Headers with mutants in the folder `work`, and the programs of tests with them."""

    def __init__(self, work, compiler):
        self.work, self.include = work, work / "include"
        self.compiler = compiler
        self.placed = {}  # the header, line, kind, text before and after of each mutant
        self.noticed = {}  # by which test source
        self.judges = {}  # the test sources that execute a mutant
        shutil.rmtree(self.include, ignore_errors=True)
        shutil.copytree(ROOT / "include", self.include)
        version = (ROOT / "cmake" / "version.h.in").read_text(encoding="utf-8")
        version = re.sub(r"@\w+@", "0", version)
        (self.include / "pcs" / "version.h").write_text(version, encoding="utf-8")

    def place(self, places, count, random_choice):
        for header, number in places:
            if len(self.placed) == count:
                break
            lines = (ROOT / "include" / "pcs" / header).read_text(encoding="utf-8").split("\n")
            choices = mutants(lines, number, len(self.placed))
            if choices:
                kind, text = random_choice.choice(choices)
                self.placed[len(self.placed)] = (header, number, kind, lines[number - 1], text)
        (self.work / "switch.h").write_text(SWITCH.replace("COUNT", str(count)), encoding="utf-8")
        self.write({mutant[0] for mutant in self.placed.values()})

    def write(self, headers):
        for header in headers:
            lines = (ROOT / "include" / "pcs" / header).read_text(encoding="utf-8").split("\n")
            for place, number, _, _, text in self.placed.values():
                if place == header:
                    lines[number - 1] = text
            (self.include / "pcs" / header).write_text("\n".join(lines), encoding="utf-8")

    def drop(self, log):
        """Takes the mutants out that the compiler rejects; whether there are any."""
        for pattern in (r"include/pcs/(\S+?):(\d+):\d+: error", r"include/pcs/(\S+?):(\d+):"):
            lines = {(header, int(number)) for header, number in re.findall(pattern, log)}
            wrong = [k for k, mutant in self.placed.items() if mutant[:2] in lines]
            if wrong:
                self.write({self.placed.pop(k)[0] for k in wrong})
                return True
        return False

    def build(self, source):
        """The program of a test, or None."""
        program = self.work / "program"
        text = source.read_text(encoding="utf-8")
        support = [ROOT / "test" / f"{name}.cpp"
                   for name in re.findall(r'#include [<"](support/\w+)\.h[>"]', text)]
        sources = [source] + [path for path in support if path.exists()]
        command = [*self.compiler, *FLAGS, "-include", str(self.work / "switch.h"),
                   f"-I{self.include}", *map(str, sources), "-o", str(program), *LIBRARIES]
        while True:
            result = subprocess.run(command, capture_output=True, text=True, check=False)
            if result.returncode == 0:
                return program
            if not self.drop(result.stderr):
                return None

    def run(self, program, timeout, **environment):
        """Whether the program passes in the time."""
        try:
            return subprocess.run([str(program)], cwd=self.work, timeout=timeout, check=False,
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                  env={**os.environ, **environment},
                                  preexec_fn=limit_memory).returncode == 0
        except subprocess.TimeoutExpired:
            return False

    def judge(self, source, most_seconds):
        """Runs a test with every mutant that it executes and that no test noticed."""
        program = self.build(source)
        if program is None:
            return "does not compile alone"
        start, reached = time.monotonic(), self.work / "reached.txt"
        if not self.run(program, most_seconds, PCS_REACHED=str(reached)):
            return "fails or takes too long without a change"
        seconds, count = time.monotonic() - start, 0
        for k in map(int, reached.read_text(encoding="utf-8").split()):
            self.judges.setdefault(k, []).append(source.stem)
            if k in self.placed and k not in self.noticed:
                count += 1
                if not self.run(program, 10 * seconds + 5, PCS_MUTANT=str(k)):
                    self.noticed[k] = source.stem
        return f"{count} mutants"

    def survivors(self):
        return [k for k in self.judges if k in self.placed and k not in self.noticed]

    def report(self):
        judged = [k for k in self.judges if k in self.placed]
        for k in self.survivors():
            header, number, kind, before, after = self.placed[k]
            print(f"{header}:{number}: {kind} survives {', '.join(self.judges[k])}\n"
                  f"  - {before.strip()}\n  + {after.strip()}")
        for title, key in (("change", lambda k: self.placed[k][2]),
                           ("folder", lambda k: folder_of(self.placed[k][0]))):
            print(f"\n| {title} | mutants | noticed | survive |\n|---|---|---|---|")
            for group in [*sorted({key(k) for k in judged}), "all"]:
                members = [k for k in judged if group in (key(k), "all")]
                noticed = sum(k in self.noticed for k in members)
                print(f"| {group} | {len(members)} | {noticed} | {len(members) - noticed} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--covered", type=pathlib.Path, required=True,
                        help="the file that test/coverage.py --json wrote")
    parser.add_argument("--count", type=int, default=400, help="number of changes")
    parser.add_argument("--tests", type=int, default=14, help="number of test sources")
    parser.add_argument("--seed", type=int, default=1, help="of the random choice")
    parser.add_argument("--minutes", type=float, default=60, help="no test source begins later")
    parser.add_argument("--folder", default="", help="only headers below this folder")
    parser.add_argument("--headers", type=int, default=30,
                        help="test sources that include more headers of pcs are not used")
    parser.add_argument("--seconds", type=float, default=10,
                        help="tests that take longer without a change are not used")
    parser.add_argument("--compiler", default="g++", help="for example `ccache g++`")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build" / "mutation")
    arguments = parser.parse_args()
    covered = json.loads(arguments.covered.read_text(encoding="utf-8"))
    random_choice = random.Random(arguments.seed)
    end = time.monotonic() + 60 * arguments.minutes
    available = Sources()
    small = [path for path, size in available.sizes.items() if size <= arguments.headers
             and any(name.startswith(arguments.folder) for name in available.tests[path])]
    random_choice.shuffle(small)
    small = in_turn(small, lambda path: folder_of(path.relative_to(ROOT / "test").as_posix()))
    sources = list(itertools.islice(small, arguments.tests))
    headers = {name for path in sources for name in available.tests[path]}
    places = [(name, int(line)) for name in sorted(covered)
              if name in headers and name.startswith(arguments.folder)
              for line in covered[name] if covered[name][line]]
    if not places:
        sys.exit(f"test/mutation.py: {arguments.covered} has no covered line in the folder "
                 f"`{arguments.folder}` that a test source with at most {arguments.headers} "
                 "headers includes")
    random_choice.shuffle(places)
    changed = Mutants(arguments.work, arguments.compiler.split())
    changed.place(in_turn(places, lambda place: folder_of(place[0])), arguments.count,
                  random_choice)
    for source in sources:
        if time.monotonic() < end:
            print(f"{source.stem}: {changed.judge(source, arguments.seconds)}", flush=True)
    others = {path: None for k in changed.survivors() for path in available.of(changed.placed[k][0])
              if path not in sources and available.sizes[path] <= arguments.headers}
    for source in others:
        if time.monotonic() < end:
            print(f"{source.stem}: {changed.judge(source, arguments.seconds)}", flush=True)
    changed.report()


if __name__ == "__main__":
    main()
