#!/usr/bin/env python3
# Copyright (c) 2026 The pcs authors
# SPDX-License-Identifier: BSL-1.0
"""Makes a virtual plot with known trees, measures the programs of the plot workflow, and compares
its results with the truth.

  plot_workflow.py make     --programs BIN --folder PLOT --side 8 --step-degrees 0.045
  plot_workflow.py wrap     --programs BIN --folder PLOT
  snakemake --snakefile examples/plot_workflow/Snakefile --directory PLOT/run --cores 2 \\
            --config inputs='["../scans/*.ply"]' programs=PLOT/programs voxel=0.03 \\
            tile_points=2000000
  plot_workflow.py evaluate --folder PLOT
  plot_workflow.py cut      --folder PLOT --points 3000000 --voxel 0.03

The last command writes PLOT/part.ply, the points of a square in a corner of the plot.

BIN, PLOT and PLOT/programs are absolute paths. Needs the standard library only.
"""

import argparse
import array
import csv
import itertools
import json
import math
import os
import random
import struct
import subprocess
import sys

PRESETS = ("broadleaf", "conifer", "fruit", "forked")
SPACING, SLOPE, X0, Y0, Z0 = 6.5, 0.2, 500000, 5400000, 300
SCAN = (("x", "d"), ("y", "d"), ("z", "d"), ("node", "i"), ("station", "i"), ("truth", "i"))
TYPES = {"double": "d", "float": "f", "int": "i", "uint": "I", "uchar": "B", "ushort": "H"}
GROUND, GHOST = -2, -1
GHOSTS = 2  # height below which ghosts follow the ground, the more the lower they are [m]

WRAPPER = """#!/usr/bin/env python3
import resource, subprocess, sys, time
start = time.time()
code = subprocess.run([{program!r}] + sys.argv[1:]).returncode
used = resource.getrusage(resource.RUSAGE_CHILDREN)
with open({log!r}, "a") as log:
    print({name!r}, f"{{time.time() - start:.1f}}", f"{{used.ru_utime + used.ru_stime:.1f}}",
          used.ru_maxrss, file=log)
sys.exit(code if code >= 0 else 128 - code)
"""


def rows_of_ply(path, chunk=200000):
    """Yields the names of the properties, and then tuples of their values."""
    with open(path, "rb") as file:
        names, layout = [], "<"
        for line in file:
            words = line.split()
            if words[0] == b"property":
                names.append(words[2].decode())
                layout += TYPES[words[1].decode()]
            if words[0] == b"end_header":
                break
        yield names
        row = struct.Struct(layout)
        while data := file.read(row.size * chunk):
            yield from row.iter_unpack(data)


def write_scan(path, parts):
    size = struct.calcsize("<" + "".join(t for _, t in SCAN))
    header = ["ply", "format binary_little_endian 1.0"]
    header.append(f"element vertex {sum(map(len, parts)) // size}")
    header += [f"property {'double' if t == 'd' else 'int'} {name}" for name, t in SCAN]
    with open(path, "wb") as file:
        file.write(("\n".join(header) + "\nend_header\n").encode())
        for part in parts:
            file.write(part)


def true_tree(path, x, y):
    """Foot, diameter at breast height and height from the true skeleton."""
    with open(path, newline="", encoding="ascii") as file:
        nodes = list(csv.DictReader(file))
    stem = sorted((float(n["z"]), float(n["r"]), n) for n in nodes if n["order"] == "0")
    above = next(k for k, node in enumerate(stem) if node[0] > 1.3)
    (z, r, _), (z1, r1, _) = stem[above - 1], stem[above]
    radius = r + (r1 - r) * (1.3 - z) / (z1 - z)
    foot = stem[0][2]
    position = {"x": x + float(foot["x"]), "y": y + float(foot["y"])}
    return {**position, "dbh": 2 * radius, "height": max(float(n["z"]) for n in nodes)}


def shear(node, height):
    """Returns how much of the slope a point follows. Ghosts lie between the ground and a tree."""
    if node == GROUND:
        return 1
    return min(1, max(0, 1 - height / GHOSTS)) if node == GHOST else 0


def make(arguments):
    """One tree at a time is scanned with the ground around it; trees do not hide each other."""
    scans, one = os.path.join(arguments.folder, "scans"), os.path.join(arguments.folder, "one")
    if arguments.side < 1 or not arguments.step_degrees > 0:
        sys.exit("plot_workflow.py: --side and --step-degrees must be more than 0")
    if not os.path.exists(os.path.join(arguments.programs or "", "virtual_scan")):
        sys.exit("plot_workflow.py: --programs has no virtual_scan; build the programs first")
    if os.path.exists(scans):
        sys.exit(f"plot_workflow.py: {scans} exists; choose another --folder, or remove it")
    os.makedirs(scans)
    side, trees, total = arguments.side, [], 0
    shift = random.Random(7)
    row = struct.Struct("<" + "".join(t for _, t in SCAN))
    for line in range(side):
        parts = []
        for column in range(side):
            number = line * side + column
            x = X0 + SPACING * column + shift.uniform(-0.8, 0.8)
            y = Y0 + SPACING * line + shift.uniform(-0.8, 0.8)
            command = [os.path.join(arguments.programs, "virtual_scan"), "--quiet", "--ground", "5"]
            command += ["--preset", PRESETS[number % 4], "--seed", str(number + 1)]
            command += ["--height", str(8 + number * 7 % 9), "--output", one + ".ply"]
            command += ["--step-degrees", str(arguments.step_degrees), "--truth", one + ".csv"]
            subprocess.run(command, check=True)
            foot, packed = Z0 + SLOPE * (x - X0), []
            points = rows_of_ply(one + ".ply")
            next(points)
            for px, py, pz, node, station in points:  # the ground is sheared, the tree is upright
                z = pz + foot + SLOPE * px * shear(node, pz)
                truth = number if node >= 0 else node
                packed.append(row.pack(px + x, py + y, z, node, station, truth))
            parts.append(b"".join(packed))
            total += len(packed)
            trees.append(true_tree(one + ".csv", x, y))
        write_scan(os.path.join(scans, f"scan_{line:03d}.ply"), parts)
    for extension in (".ply", ".csv"):
        os.remove(one + extension)
    with open(os.path.join(arguments.folder, "truth.json"), "w", encoding="ascii") as file:
        json.dump(trees, file)
    print(f"{len(trees)} trees, {total} points")


def cut(arguments):
    """Writes the points of a square in a corner, with one point per voxel if `voxel` is not 0."""
    scans = os.path.join(arguments.folder, "scans")
    kept, voxels = array.array("d"), set()
    low = (X0 - SPACING / 2, Y0 - SPACING / 2)
    counts = [0] * 100000  # of the points by the side of the square that reaches them, in cm
    for name in sorted(os.listdir(scans)):
        rows = rows_of_ply(os.path.join(scans, name))
        next(rows)  # names
        for row in rows:
            x, y, z = row[:3]
            if x < low[0] or y < low[1]:
                continue
            if arguments.voxel:
                v = arguments.voxel
                key = (math.floor(x / v), math.floor(y / v), math.floor(z / v))
                if key in voxels:
                    continue
                voxels.add(key)
            kept.extend((x, y, z))
            counts[int(100 * max(x - low[0], y - low[1]))] += 1
    side = next((k for k, n in enumerate(itertools.accumulate(counts)) if n >= arguments.points),
                len(counts))
    part = array.array("d")
    for i in range(0, len(kept), 3):
        if 100 * max(kept[i] - low[0], kept[i + 1] - low[1]) < side + 1:
            part.extend(kept[i:i + 3])
    with open(os.path.join(arguments.folder, "part.ply"), "wb") as file:
        properties = "".join(f"property double {c}\n" for c in "xyz")
        file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {len(part) // 3}\n"
                   f"{properties}end_header\n".encode())
        part.tofile(file)
    print(f"{len(part) // 3} points, side {(side + 1) / 100} m")


def wrap(arguments):
    """Writes programs that log their name, seconds, processor seconds and kilobytes."""
    folder = os.path.join(arguments.folder, "programs")
    os.makedirs(folder, exist_ok=True)
    for name in ("tile_points", "segment_trees", "merge_tiles", "extract_tree_skeleton"):
        path = os.path.join(folder, name)
        program = os.path.join(arguments.programs, name)
        with open(path, "w", encoding="utf-8") as file:
            log = os.path.join(arguments.folder, "usage.txt")
            file.write(WRAPPER.format(program=program, log=log, name=name))
        os.chmod(path, 0o755)


def match(truth, rows):
    """Returns the row of each true tree: the nearest feet first, at most 0.5 m apart."""
    pairs = sorted(
        (math.hypot(float(row["x"]) - tree["x"], float(row["y"]) - tree["y"]), t, k)
        for t, tree in enumerate(truth)
        for k, row in enumerate(rows)
    )
    found, used = {}, set()
    for distance, t, k in pairs:
        if distance <= 0.5 and t not in found and k not in used:
            found[t] = k
            used.add(k)
    return found


def spread(name, unit, errors):
    sizes = sorted(map(abs, errors))
    print(
        f"{name}: {len(errors)} trees, median error {sorted(errors)[len(errors) // 2]:.3f} {unit},"
        f" median size {sizes[len(sizes) // 2]:.3f}, 90th percentile"
        f" {sizes[int(0.9 * (len(sizes) - 1))]:.3f}, largest {sizes[-1]:.3f}"
    )


def evaluate(arguments):
    with open(os.path.join(arguments.folder, "truth.json"), encoding="ascii") as file:
        truth = json.load(file)
    run = os.path.join(arguments.folder, "run")
    with open(os.path.join(run, "results", "trees.csv"), newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    found = match(truth, rows)
    print(
        f"true trees {len(truth)}, found {len(found)}, missed {len(truth) - len(found)},"
        f" false {len(rows) - len(found)}; missed: {sorted(set(range(len(truth))) - set(found))}"
    )
    dbh = [(truth[t]["dbh"], rows[k]["dbh"]) for t, k in found.items() if rows[k]["dbh"]]
    spread("dbh", "%", [100 * (float(value) / true - 1) for true, value in dbh])
    height = [(truth[t]["height"], rows[k]["height"]) for t, k in found.items()]
    spread("height", "m", [float(value) - true for true, value in height if value])
    tree_of = {int(rows[k]["tree"]): t for t, k in found.items()}
    points = rows_of_ply(os.path.join(run, "merged", "labelled.ply"))
    names = next(points)
    truth_at, tree_at = names.index("truth"), names.index("tree")
    count = dict.fromkeys(("all", "wood", "right", "none", "ground", "wrong"), 0)
    for point in points:
        true, tree = point[truth_at], point[tree_at]
        count["all"] += 1
        if true >= 0:
            count["wood"] += 1
            count["right"] += tree_of.get(tree) == true
            count["none"] += tree < 0
        elif true == GROUND:
            count["ground"] += 1
            count["wrong"] += tree >= 0
    print(
        f"points {count['all']}; of {count['wood']} points of trees: right"
        f" {100 * count['right'] / count['wood']:.2f} %, without tree"
        f" {100 * count['none'] / count['wood']:.2f} %; ground with a tree"
        f" {100 * count['wrong'] / max(1, count['ground']):.2f} %"
    )
    usage = {}
    with open(os.path.join(arguments.folder, "usage.txt"), encoding="ascii") as file:
        for name, *values in map(str.split, file):
            usage.setdefault(name, []).append([float(value) for value in values])
    for name, runs in usage.items():
        print(
            f"{name}: {len(runs)} runs, {sum(r[0] for r in runs):.0f} s, processor"
            f" {sum(r[1] for r in runs):.0f} s, largest {max(r[2] for r in runs) / 1000:.0f} MB"
        )


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("step", choices=("make", "wrap", "evaluate", "cut"))
    parser.add_argument("--folder", required=True, help="folder of the plot")
    parser.add_argument("--programs", help="make, wrap: folder of the built programs")
    parser.add_argument("--side", type=int, default=8, help="make: trees along each side")
    parser.add_argument("--step-degrees", type=float, default=0.045, help="make: angle of beams")
    parser.add_argument("--points", type=int, default=1000000, help="cut: least number of points")
    parser.add_argument("--voxel", type=float, default=0, help="cut: voxel size of thinning; 0: none")
    arguments = parser.parse_args()
    if arguments.step in ("make", "wrap") and not arguments.programs:
        sys.exit("plot_workflow.py: --programs is required")
    step = {"make": make, "wrap": wrap, "evaluate": evaluate, "cut": cut}[arguments.step]
    try:
        step(arguments)
    except subprocess.CalledProcessError as error:
        sys.exit(f"plot_workflow.py: {error.cmd[0]} failed with exit code {error.returncode}")
    except (OSError, StopIteration, KeyError, ValueError, struct.error) as error:
        sys.exit(
            f"plot_workflow.py: {arguments.step}: {type(error).__name__} {error}; a file of"
            f" {arguments.folder} is missing, cut, or not of the step before"
        )


if __name__ == "__main__":
    main()
