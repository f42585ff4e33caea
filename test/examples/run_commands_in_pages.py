#!/usr/bin/env python3
# Copyright (c) 2026 The pcs authors
# SPDX-License-Identifier: BSL-1.0
"""Runs the commands in README.md and in the user manual, and checks that all options in them exist.

    run_commands_in_pages.py --programs build/release/examples/programs --root .

A command is a line of a code block that begins with the name of a program, with or without its
folder. Words in capitals, and files that the reader is expected to have, are replaced by small
virtual scans. Parts in brackets are optional: the command is run without and with them. Commands of
a page run in the order of the page, in one folder, so that a command may read the results of the
one before.
"""

import argparse
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

PROGRAMS = (
    "deform_point_set",
    "extract_tree_skeleton",
    "fit_point_set",
    "fit_tree_habit",
    "merge_tiles",
    "orl_geodesic",
    "sample_mesh",
    "segment_trees",
    "tile_points",
    "virtual_scan",
    "write_gallery",
)
OTHER_OPTIONS = {  # of snakemake, pkg-config, vcpkg, cmake and evaluate_skeleton
    "--cflags", "--libs", "--overlay-ports", "--build", "--result",
    "--snakefile", "--config", "--cores", "--profile", "--rerun-incomplete", "--keep-going",
    "--resources", "--directory", "--forcerun", "--executor", "--jobs", "--dry-run",
}  # fmt: skip
NUMBERS = {"METRES": "4", "SIZE": "0.02"}
# Quicker than what the page recommends, with the same options; and one subsample of a scan instead of
# several, unless the page gives a number.
QUICK = {"--preset broadleaf": "--preset fruit", "--step-degrees 0.05": "--step-degrees 0.4"}


def pages(root):
    manual = os.path.join(root, "doc", "user_manual")
    yield os.path.join(root, "README.md")
    yield os.path.join(root, "examples", "gallery", "README.md")
    for name in sorted(os.listdir(manual)):
        if name.endswith(".md"):
            yield os.path.join(manual, name)


def commands(path):
    """Yields the number of the first line and the text of each command of a page."""
    with open(path, encoding="utf-8") as file:
        lines = file.read().splitlines()
    is_code, k = False, 0
    while k < len(lines):
        line, first = lines[k], k + 1
        k += 1
        if line.startswith("```"):
            is_code = not is_code
        if not is_code and not line.startswith("    "):
            continue
        word = os.path.basename(line.split()[0]) if line.split() else ""
        if word not in PROGRAMS:
            continue
        text = line.strip()
        while k < len(lines) and (
            text.endswith("\\") or re.match(r" {8,}[\[-]", lines[k])  # continued
        ):
            text = text.rstrip("\\") + " " + lines[k].strip()
            k += 1
        yield first, text


def without_optional_parts(text):
    return re.sub(r"\[[^\]]*\]", "", text)


def with_optional_parts(text):
    return text.replace("[", "").replace("]", "")


def expand(text, folder):
    """Returns the words of the command with existing files and numbers."""
    for name, value in QUICK.items():
        text = text.replace(name, value)
    words = []
    for word in shlex.split(text):
        if word in NUMBERS:
            words.append(NUMBERS[word])
        elif word in ("SCAN...", "FILE..."):
            words += ["A.ply", "B.ply"] if word == "SCAN..." else ["STAND.ply"]
        elif "*" in word:
            parent, pattern = os.path.split(word)
            names = sorted(os.listdir(os.path.join(folder, parent)))
            words += [os.path.join(parent, n) for n in names if n.endswith(pattern.lstrip("*"))]
        else:
            words.append(word)
    return words


def scan(programs, folder, name, seed, stations=3, degrees=0.3):
    """Makes the scan, the skeleton and the report of a small tree."""
    subprocess.run(
        [
            os.path.join(programs, "virtual_scan"), "--preset", "fruit", "--stations",
            str(stations), "--step-degrees", str(degrees), "--seed", str(seed), "--output",
            name + ".xyz", "--swc", name + ".swc", "--report", name + ".json", "--quiet",
        ],
        cwd=folder, check=True,
    )  # fmt: skip
    with open(os.path.join(folder, name + ".xyz"), encoding="ascii") as file:
        rows = [line.split()[:3] for line in file if not line.startswith("#")]
    return [row for row in rows if re.match(r"^[-+0-9.]", row[0])]


def write_ply(path, rows):
    with open(path, "w", encoding="ascii") as file:
        file.write(f"ply\nformat ascii 1.0\nelement vertex {len(rows)}\n")
        file.write("".join(f"property double {c}\n" for c in "xyz") + "end_header\n")
        file.writelines(" ".join(map(str, row)) + "\n" for row in rows)


def make_inputs(programs, folder):
    """Makes the files that the commands expect."""
    trees = {name: scan(programs, folder, name, seed) for seed, name in enumerate("ABC", 1)}
    for name, rows in trees.items():
        write_ply(os.path.join(folder, name + ".ply"), rows)
    shutil.copy(os.path.join(folder, "A.ply"), os.path.join(folder, "SCAN.ply"))
    # the tree of A, from one station
    write_ply(
        os.path.join(folder, "STATION.ply"), scan(programs, folder, "STATION", 1, 1, degrees=0.1)
    )
    for name, copy in (("A", "oak_1"), ("B", "oak_2"), ("C", "unknown")):
        shutil.copy(os.path.join(folder, name + ".swc"), os.path.join(folder, copy + ".swc"))
    stand = [
        [float(x) + 8 * k, float(y), float(z)]
        for k, rows in enumerate(trees.values())
        for x, y, z in rows
    ]
    write_ply(os.path.join(folder, "STAND.ply"), stand)
    with open(os.path.join(folder, "pairs.json"), "w", encoding="ascii") as file:
        rows = trees["A"]
        pairs = [{"point": i, "target": [float(c) for c in rows[i]]} for i in (0, 9, 90)]
        json.dump(pairs, file)
    with open(os.path.join(folder, "TREE.obj"), "w", encoding="ascii") as file:
        file.write("v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n")
    # what the gallery shows
    subprocess.run(
        [
            os.path.join(programs, "extract_tree_skeleton"), "--input", "SCAN.ply",
            "--swc", "tree.swc", "--points", "tree_points.ply", "--mesh", "tree_mesh.ply",
            "--cylinders", "tree_cylinders.csv", "--report", "tree.json", "--resamples", "1",
        ],
        cwd=folder, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    os.makedirs(os.path.join(folder, "examples", "gallery"))


def place_scanner(words, folder):
    """Replaces the position of the scanner and the scan by those of a scan from one station."""
    if "--scanner" not in words:
        return words
    with open(os.path.join(folder, "STATION.json"), encoding="ascii") as file:
        position = json.load(file)["stations"][0]
    first = words.index("--scanner") + 1
    words = words[:first] + [str(x) for x in position] + words[first + 3 :]
    return ["STATION.ply" if word == "SCAN.ply" else word for word in words]


def run(text, programs, folder):
    """Returns what is wrong with the command, or nothing."""
    words = ["SCAN.ply" if word == "SCAN" else word for word in expand(text, folder)]
    words = place_scanner(words, folder)
    if os.path.basename(words[0]) == "extract_tree_skeleton" and "--resamples" not in words:
        words += ["--resamples", "1"]
    done = subprocess.run(
        [os.path.join(programs, os.path.basename(words[0])), *words[1:]],
        cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
    )  # fmt: skip
    return "" if done.returncode == 0 else f"exit code {done.returncode}: {done.stdout[-400:]}"


def run_page(page, inputs, options):
    """Runs the commands of a page. Returns their number and the faults."""
    runs = []
    with tempfile.TemporaryDirectory() as outer:
        folder, copy = os.path.join(outer, "page"), os.path.join(outer, "copy")
        shutil.copytree(inputs, folder, symlinks=True)
        for line, text in commands(page):
            short, whole = without_optional_parts(text), with_optional_parts(text)
            if short != whole:  # the next command may read what the whole one writes
                shutil.copytree(folder, copy, symlinks=True)
                runs.append((line, short, run(short, options.programs, copy)))
                shutil.rmtree(copy)
            runs.append((line, whole, run(whole, options.programs, folder)))
    return len(runs), [f"{page}:{line}: {text}\n  {fault}" for line, text, fault in runs if fault]


def check_options(options):
    """Returns options in the pages that no program has."""
    known = set(OTHER_OPTIONS)
    for program in PROGRAMS:
        path = os.path.join(options.programs, program)
        done = subprocess.run([path, "--help"], stdout=subprocess.PIPE, text=True, check=True)
        known |= set(re.findall(r"--[a-z][a-z0-9-]*", done.stdout))
    faults = []
    for page in pages(options.root):
        with open(page, encoding="utf-8") as file:
            for number, line in enumerate(file, 1):
                for code in re.findall(r"`([^`]*)`", line):
                    for option in re.findall(r"(?<![\w-])--[a-z][a-z0-9-]*", code):
                        if option not in known:
                            faults.append(f"{page}:{number}: no program has the option {option}")
    return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--programs", required=True, help="folder of the built programs")
    parser.add_argument("--root", required=True, help="folder of README.md")
    options = parser.parse_args()
    options.programs = os.path.abspath(options.programs)
    faults, number = check_options(options), 0
    with tempfile.TemporaryDirectory() as inputs:
        make_inputs(options.programs, inputs)
        gallery = os.path.join(os.path.abspath(options.root), "examples", "gallery", "page")
        os.symlink(gallery, os.path.join(inputs, "examples", "gallery", "page"))
        for page in pages(options.root):
            number_of_page, faults_of_page = run_page(page, inputs, options)
            number += number_of_page
            faults += faults_of_page
    print("\n".join([*faults, f"{number} commands, {len(faults)} faults"]))
    return 1 if faults or number == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
