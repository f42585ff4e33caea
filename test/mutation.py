#!/usr/bin/env python3
# Copyright (c) 2026 The pcs authors
# SPDX-License-Identifier: BSL-1.0
"""Changes single lines of include/pcs, and reports which changes the tests notice.

    test/coverage.py --build build/coverage --json build/covered.json
    test/mutation.py --covered build/covered.json --count 40 --seed 1

A mutant has one change in a line that the tests execute: a comparison is inverted, + and - are
exchanged, a constant is one larger, a condition is negated, or a statement is removed. The test
sources nearest to the changed header (those that include it, or else those that include a header
that does) are compiled with it, without optimisation, each as a program of its own, and run. A
mutant is `noticed` if one of them fails or takes ten times as long, and `survives` otherwise; the
other tests might notice it still. The changed header is in the folder --work, include/pcs is not
touched.

Needs Python 3 without further packages, and the packages that the tests need.
"""

import argparse
import json
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

INVERSE = {"<": ">=", ">": "<=", "<=": ">", ">=": "<", "==": "!=", "!=": "=="}
SIGN = {"+": "-", "-": "+", "+=": "-=", "-=": "+="}
NO_CODE = re.compile(r"^\s*(#|//|/?\*|template\b|using\b|namespace\b|static_assert\b|struct\b|"
                     r"class\b|friend\b|public:|private:|CGAL_|BOOST_)")


def swap(text, pattern, table, kind):
    """One mutant for each match of an operator between blanks."""
    for match in re.finditer(pattern, text):
        yield kind, text[:match.start(1)] + table[match.group(1)] + text[match.end(1):]


def constants(text):
    for match in re.finditer(r"(?<![\w.\[<])(\d+(?:\.\d+)?)(?![\w.>])", text):
        number = match.group()
        larger = str(int(number) + 1) if "." not in number else repr(float(number) + 1)
        yield "constant", text[:match.start()] + larger + text[match.end():]


def conditions(text):
    match = re.match(r"^(\s*(?:\} else )?(?:if|while) \()(.*)(\)(?: \{)?\s*)$", text)
    if match and match.group(2).count("(") == match.group(2).count(")"):
        yield "condition", f"{match.group(1)}!({match.group(2)}){match.group(3)}"


def statements(lines, index):
    """An assignment or a call that is one line."""
    text, before = lines[index].rstrip(), lines[index - 1].rstrip()
    is_whole = before.endswith((";", "{", "}")) and text.endswith(";")
    if is_whole and re.match(r"^\s*[\w.\->\[\]()*:]+(\s[-+*/|&]?=\s|\(|\+\+;|--;)", text) \
            and not re.match(r"^\s*(return|throw|else|for|while|do|if|break)\b", text):
        yield "statement", re.match(r"^\s*", text).group() + ";"


def mutants(lines, number):
    """All changes of a line, as pairs of kind and new text."""
    text = lines[number - 1]
    if NO_CODE.match(text):
        return []
    found = list(statements(lines, number - 1))
    if '"' not in text and "//" not in text:
        found += swap(text, r" (<=|>=|==|!=|<|>) ", INVERSE, "comparison")
        found += swap(text, r" (\+=|-=|\+|-) ", SIGN, "sign")
        found += constants(text)
        found += conditions(text)
    return found


class Includers:
    """Which test sources include a header, directly or by as few headers as possible."""

    def __init__(self):
        tests = [p for p in (ROOT / "test").rglob("test_*.cpp") if "compile_fail" not in p.parts]
        self.tests = {path: self.headers_in(path) for path in sorted(tests)}
        self.texts = {path: path.read_text(encoding="utf-8").lower() for path in tests}
        root = ROOT / "include" / "pcs"
        self.headers = {str(p.relative_to(root)): self.headers_in(p) for p in root.rglob("*.h")}

    @staticmethod
    def headers_in(path):
        return set(re.findall(r"#include <pcs/(.*)>", path.read_text(encoding="utf-8")))

    def of(self, header):
        """The test sources; those that name words of the header's name most often are the first."""
        reached, last = {header}, {header}
        while last:
            found = [path for path, headers in self.tests.items() if headers & last]
            if found:
                words = [w for w in pathlib.Path(header).stem.lower().split("_") if len(w) > 2]
                return sorted(found, key=lambda path: -sum(map(self.texts[path].count, words)))
            last = {name for name, headers in self.headers.items() if headers & last} - reached
            reached |= last
        return []


def limit_memory():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


class Judge:
    """Compiles test sources with the headers in `work`, and runs them."""

    def __init__(self, work, compiler):
        self.include = work / "include"
        self.work = work
        self.compiler = compiler
        self.seconds = {}  # of tests with the headers as they are
        shutil.rmtree(self.include, ignore_errors=True)
        shutil.copytree(ROOT / "include", self.include)
        version = (ROOT / "cmake" / "version.h.in").read_text(encoding="utf-8")
        version = re.sub(r"@\w+@", "0", version)
        (self.include / "pcs" / "version.h").write_text(version, encoding="utf-8")

    def build(self, source):
        """The program of a test, or None."""
        program = self.work / "program"
        text = source.read_text(encoding="utf-8")
        support = [ROOT / "test" / f"{name}.cpp"
                   for name in re.findall(r'#include [<"](support/\w+)\.h[>"]', text)]
        sources = [source] + [path for path in support if path.exists()]
        command = [*self.compiler, *FLAGS, f"-I{self.include}", *map(str, sources),
                   "-o", str(program), *LIBRARIES]
        with open(self.work / "compiler.log", "w", encoding="utf-8") as log:
            status = subprocess.run(command, stdout=log, stderr=log, check=False).returncode
        return program if status == 0 else None

    def run(self, program, timeout):
        """`passes`, `fails` or `hangs`."""
        try:
            status = subprocess.run([str(program)], cwd=self.work, timeout=timeout, check=False,
                                    stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                    preexec_fn=limit_memory).returncode
        except subprocess.TimeoutExpired:
            return "hangs"
        return "passes" if status == 0 else "fails"

    def is_usable(self, source, most_seconds):
        """Whether the test compiles alone, and passes in the time with the headers as they are."""
        if source not in self.seconds:
            program = self.build(source)
            start = time.monotonic()
            passes = program is not None and self.run(program, most_seconds) == "passes"
            self.seconds[source] = time.monotonic() - start if passes else None
        return self.seconds[source] is not None

    def verdict(self, header, lines, sources):
        """What the tests say about a header with these lines."""
        place = self.include / "pcs" / header
        original = place.read_text(encoding="utf-8")
        place.write_text("\n".join(lines), encoding="utf-8")
        try:
            for source in sources:
                program = self.build(source)
                if program is None:
                    return "does not compile"
                if self.run(program, 10 * self.seconds[source] + 10) != "passes":
                    return f"noticed by {source.stem}"
        finally:
            place.write_text(original, encoding="utf-8")
        return "survives"


def report(results):
    kinds = sorted({kind for kind, _ in results})
    print("\n| change | mutants | noticed | survive |\n|---|---|---|---|")
    for kind in [*kinds, "all"]:
        verdicts = [verdict for k, verdict in results if kind in (k, "all")]
        survive = verdicts.count("survives")
        print(f"| {kind} | {len(verdicts)} | {len(verdicts) - survive} | {survive} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--covered", type=pathlib.Path, required=True,
                        help="the file that test/coverage.py --json wrote")
    parser.add_argument("--count", type=int, default=40, help="number of mutants")
    parser.add_argument("--seed", type=int, default=1, help="of the random choice")
    parser.add_argument("--minutes", type=float, default=60, help="no mutant begins later")
    parser.add_argument("--folder", default="", help="only headers below this folder")
    parser.add_argument("--sources", type=int, default=3, help="most test sources of a mutant")
    parser.add_argument("--seconds", type=float, default=60,
                        help="tests that take longer without a change are not used")
    parser.add_argument("--compiler", default="g++", help="for example `ccache g++`")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build" / "mutation")
    arguments = parser.parse_args()
    covered = json.loads(arguments.covered.read_text(encoding="utf-8"))
    places = [(name, int(line)) for name in sorted(covered) if name.startswith(arguments.folder)
              for line in covered[name] if covered[name][line]]
    if not places:
        sys.exit(f"test/mutation.py: {arguments.covered} has no covered line in the folder "
                 f"`{arguments.folder}`")
    random_choice = random.Random(arguments.seed)
    random_choice.shuffle(places)
    includers = Includers()
    judge = Judge(arguments.work, arguments.compiler.split())
    end = time.monotonic() + 60 * arguments.minutes
    results = []
    for header, number in places:
        if len(results) == arguments.count or time.monotonic() > end:
            break
        lines = (ROOT / "include" / "pcs" / header).read_text(encoding="utf-8").split("\n")
        choices = mutants(lines, number)
        sources = includers.of(header)[: arguments.sources]
        if not choices or not sources:
            continue
        sources = [s for s in sources if judge.is_usable(s, arguments.seconds)]
        if not sources:
            continue
        kind, text = random_choice.choice(choices)
        changed = lines[: number - 1] + [text] + lines[number:]
        verdict = judge.verdict(header, changed, sources)
        print(f"{header}:{number}: {kind}: {verdict}\n  - {lines[number - 1].strip()}\n"
              f"  + {text.strip()}", flush=True)
        if verdict != "does not compile":
            results.append((kind, verdict))
    report(results)


if __name__ == "__main__":
    main()
