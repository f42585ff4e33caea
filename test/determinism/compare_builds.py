#!/usr/bin/env python3
# Copyright (c) 2026 The pcs authors
# SPDX-License-Identifier: BSL-1.0
"""Builds the program record_results with different compilers and options, and compares the values it writes.

    test/determinism/compare_builds.py [--work build/determinism] [--jobs 1] [BUILD ...]

The first build, `release`, is always made; the others are compared with it. Prints a table in Markdown: how many
results are equal bit by bit, and how far the others differ. The difference of two results is the largest difference of
two values, divided by the root mean square of all values of the result; results with other numbers of values are named.
Builds are kept in the folder --work.

Needs Python 3 without further packages, and the packages that the tests need; clang++ for the builds of that name.
"""

import argparse
import array
import math
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
RELEASE = {"CMAKE_BUILD_TYPE": "Release", "PCS_WITH_TBB": "ON", "PCS_LINK_COMPILED": "OFF",
           "PCS_BUILD_TESTS": "ON", "PCS_BUILD_EXAMPLES": "OFF"}
BUILDS = {
    "release": ("g++, Release", {}),
    "compiled": ("g++, Release, `pcs::compiled`", {"PCS_LINK_COMPILED": "ON"}),
    "no-tbb": ("g++, Release, without oneTBB", {"PCS_WITH_TBB": "OFF"}),
    "debug": ("g++, Debug", {"CMAKE_BUILD_TYPE": "Debug"}),
    "clang": ("clang++, Release", {"CMAKE_CXX_COMPILER": "clang++"}),
    "clang-no-tbb": ("clang++, Release, without oneTBB",
                     {"CMAKE_CXX_COMPILER": "clang++", "PCS_WITH_TBB": "OFF"}),
    "native": ("g++, Release, `-march=native`", {"CMAKE_CXX_FLAGS": "-march=native"}),
}


def run(command, log):
    with open(log, "a", encoding="utf-8") as out:
        if subprocess.run(command, stdout=out, stderr=out, check=False).returncode != 0:
            sys.exit(f"compare_builds.py: `{' '.join(map(str, command))}` failed; see {log}")


def make(name, work, jobs):
    """Builds and runs the program; returns the folder of its values."""
    folder, log = work / name, work / f"{name}.log"
    options = {**RELEASE, "CMAKE_CXX_COMPILER": "g++", "CMAKE_CXX_FLAGS": "", **BUILDS[name][1]}
    options["CMAKE_CXX_FLAGS"] += " -DPCS_TEST_ONE_TAG"
    run(["cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", *(f"-D{k}={v}" for k, v in options.items())], log)
    run(["cmake", "--build", folder, "--target", "record_results", "-j", str(jobs)], log)
    results = work / f"{name}_results"
    shutil.rmtree(results, ignore_errors=True)
    results.mkdir()
    run([folder / "test" / "determinism" / "record_results", results], log)
    return results


def read(folder):
    """The sums and the values of a build, by the names of the results."""
    results = {}
    for line in (folder / "sums.txt").read_text(encoding="utf-8").splitlines():
        checksum, _, name = line.split(" ", 2)
        values = array.array("d")
        values.frombytes((folder / f"{name}.f64").read_bytes())
        results[name] = (checksum, values)
    return results


def difference(one, two):
    """Of two lists of values, relative to their root mean square; None if they are not comparable."""
    if len(one) != len(two) or any(math.isnan(a) != math.isnan(b) for a, b in zip(one, two)):
        return None
    squares = [a * a for a in one if not math.isnan(a)]
    scale = math.sqrt(sum(squares) / len(squares)) if squares else 0
    largest = max((abs(a - b) for a, b in zip(one, two) if not math.isnan(a)), default=0)
    return largest / scale if scale > 0 else largest


def describe(reference, results):
    """The row of a build: number of equal results, and the others with their differences."""
    others = []
    for name, (checksum, values) in reference.items():
        if results[name][0] == checksum:
            continue
        d = difference(values, results[name][1])
        others.append(f"{name}: {f'{d:.1g}' if d is not None else 'other numbers of values'}")
    return f"{len(reference) - len(others)} of {len(reference)} | {'; '.join(others) or '-'}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("builds", nargs="*", metavar="BUILD", help=f"of {', '.join(BUILDS)}; default: all")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build" / "determinism")
    parser.add_argument("--jobs", type=int, default=1, help="compilers at a time")
    arguments = parser.parse_args()
    for name in arguments.builds:
        if name not in BUILDS:
            parser.error(f"there is no build `{name}`, expected one of {', '.join(BUILDS)}")
    names = ["release"] + [name for name in arguments.builds or BUILDS if name != "release"]
    arguments.work.mkdir(parents=True, exist_ok=True)
    reference = None
    print("| build | equal results | others, with their differences |\n|---|---|---|", flush=True)
    for name in names:
        results = read(make(name, arguments.work, arguments.jobs))
        reference = reference or results
        row = describe(reference, results) if name != "release" else f"{len(results)} | -"
        print(f"| {BUILDS[name][0]} | {row} |", flush=True)


if __name__ == "__main__":
    main()
