#!/usr/bin/env python3
# Copyright (c) 2026 The pcs authors
# SPDX-License-Identifier: BSL-1.0
"""Draws doc/fig/materials.svg: a pillar of points under several materials.

    doc/fig/draw_materials.py build/release/examples/programs/deform_point_set doc/fig/materials.svg

Needs Python 3 without further packages.
"""

import json
import math
import os
import subprocess
import sys
import tempfile

RINGS, AROUND, HEIGHT = 61, 40, 6.0  # points of the pillar; its radius is 0.6
RADIUS = 0.6
STRETCH = {"translate": [0, 0, 3.0]}
PRESS = {"translate": [0.8, 0, -1.2]}
PANELS = [
    ("at rest", None, []),
    ("ratio -0.5", STRETCH, ["--poisson-ratio", "-0.5"]),
    ("ratio 0", STRETCH, []),
    ("ratio 0.5", STRETCH, ["--poisson-ratio", "0.5"]),
    ("stiffness 1", PRESS, ["--tolerance", "1e-5", "--iterations", "200"]),
    ("stiffness 10", PRESS, ["--stiffness", "10", "--tolerance", "1e-5", "--iterations", "200"]),
    ("stiffness 100", PRESS, ["--stiffness", "100", "--tolerance", "1e-5", "--iterations", "200"]),
]


def pillar():
    points = []
    for ring in range(RINGS):
        for k in range(AROUND):
            angle = 2 * math.pi * (k + 0.5 * (ring % 2)) / AROUND
            height = HEIGHT * ring / (RINGS - 1)
            points.append((RADIUS * math.cos(angle), RADIUS * math.sin(angle), height))
    return points


def deform(program, points, motion, options):
    """Returns the points after the lowest eighth is held and the highest eighth is moved."""
    with tempfile.TemporaryDirectory() as folder:
        path = {name: os.path.join(folder, name) for name in ("in.xyz", "edit.json", "out.xyz")}
        with open(path["in.xyz"], "w", encoding="utf-8") as file:
            file.writelines("%r %r %r\n" % p for p in points)
        low, high = HEIGHT / 8, HEIGHT * 7 / 8
        handles = [
            {"select": {"box": [[-9, -9, -9], [9, 9, low]]}, "fixed": True},
            {"select": {"box": [[-9, -9, high], [9, 9, 99]]}, **motion},
        ]
        with open(path["edit.json"], "w", encoding="utf-8") as file:
            json.dump({"handles": handles}, file)
        subprocess.run(
            [program, "--quiet", "--input", path["in.xyz"], "--edit", path["edit.json"],
             "--output", path["out.xyz"], *options],
            check=True)
        with open(path["out.xyz"], encoding="utf-8") as file:
            lines = [line.split() for line in file if line[0] not in "#/"]
        return [tuple(map(float, line[:3])) for line in lines]


def draw_panel(points, left, bottom):
    """Returns the rings of a pillar as closed lines, seen from the front and slightly from above."""
    scale, tilt = 28, 0.3
    result = []
    for ring in range(0, RINGS, 2):
        held = ring < RINGS / 8 or ring > RINGS * 7 / 8
        line = " ".join(
            "%.1f,%.1f" % (left + scale * x, bottom - scale * (z + tilt * y))
            for x, y, z in points[ring * AROUND:(ring + 1) * AROUND])
        result.append('<polygon points="%s" stroke="%s"/>' % (line, "#c25" if held else "#357"))
    return result


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    program, output = sys.argv[1:]
    points = pillar()
    width, height, bottom = 105, 320, 280
    svg = ['<svg xmlns="http://www.w3.org/2000/svg" width="%d" height="%d" '
           'font-family="sans-serif" font-size="13">' % (width * len(PANELS), height),
           '<rect width="100%" height="100%" fill="#fff"/>',
           '<g fill="none" stroke-width="0.9">']
    for k, (_, motion, options) in enumerate(PANELS):
        shape = points if motion is None else deform(program, points, motion, options)
        svg += draw_panel(shape, width * (k + 0.42), bottom)
    svg.append('</g>')
    for k, (name, _, _) in enumerate(PANELS):
        svg.append('<text x="%.0f" y="%d" text-anchor="middle">%s</text>' %
                   (width * (k + 0.45), height - 10, name))
    svg.append('</svg>')
    with open(output, "w", encoding="utf-8") as file:
        file.write("\n".join(svg) + "\n")


if __name__ == "__main__":
    main()
