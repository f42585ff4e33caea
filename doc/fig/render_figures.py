#!/usr/bin/env python3
# Copyright (c) 2026 The pcs authors
# SPDX-License-Identifier: BSL-1.0
"""Renders the pictures of README.md and of the stages in the manual by the programs of pcs.

    cmake --build build/release --target write_stages
    doc/fig/render_figures.py --programs build/release/examples/programs --work /tmp/figures \\
        --dragon build/data/dragon.ply --scan SCAN.ply --other-scan SCAN.ply \\
        --stages build/release/examples/write_stages

`./run` downloads the dragon. The scans are those of trees without leaves. A picture is left out if
its input is not given. Needs Python 3 and numpy.

Points are drawn as discs into a depth buffer, three times as large as the picture. Shading is that
of the normals of the depth buffer, darkened where the surroundings are nearer to the eye.
"""

import argparse
import json
import os
import struct
import subprocess
import zlib

import numpy as np

FIGURES = os.path.dirname(os.path.abspath(__file__))
SCALE = 3  # samples per pixel along each axis
GREY, HELD, MOVED = (188, 193, 200), (52, 104, 168), (224, 122, 46)
FIRST, SECOND = (96, 138, 190), (222, 150, 84)  # the trees at the ends of a geodesic
TYPES = {"char": "i1", "uchar": "u1", "short": "<i2", "ushort": "<u2", "int": "<i4", "uint": "<u4"}
TYPES.update({"float": "<f4", "double": "<f8"})


# ---- files


def read_ply(path):
    """Returns the vertices of a binary or text PLY file, and its triangles or None."""
    with open(path, "rb") as file:
        elements, form = [], ""
        for line in iter(lambda: file.readline().decode("ascii").split(), ["end_header"]):
            if line[0] == "format":
                form = line[1]
            elif line[0] == "element":
                elements.append((line[1], int(line[2]), []))
            elif line[0] == "property" and line[1] != "list":
                elements[-1][2].append((line[2], TYPES[line[1]]))
            elif line[0] == "property":
                elements[-1][2].append((line[4], TYPES[line[2]], TYPES[line[3]]))
        vertices, triangles = None, None
        for name, count, fields in elements:
            is_list = any(len(field) == 3 for field in fields)
            if name == "vertex":
                kind = np.dtype(fields)
                if form == "binary_big_endian":
                    kind = kind.newbyteorder(">")
                if form == "ascii":
                    rows = np.loadtxt(file, max_rows=count, ndmin=2)
                    vertices = {f[0]: rows[:, k] for k, f in enumerate(fields)}
                else:
                    rows = np.fromfile(file, kind, count)
                    vertices = {f[0]: rows[f[0]] for f in fields}
            elif name == "face" and is_list and form == "binary_little_endian":
                kind = np.dtype([("n", fields[0][1]), ("v", fields[0][2], 3)])
                triangles = np.fromfile(file, kind, count)["v"]
            else:
                break
    return vertices, triangles


def points_of(vertices):
    return np.column_stack([vertices[c].astype(float) for c in "xyz"])


def write_png(path, image):
    height, width, _ = image.shape
    rows = b"".join(b"\0" + image[i].tobytes() for i in range(height))

    def chunk(kind, data):
        body = kind + data
        return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header))
        file.write(chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


# ---- drawing


def blur(image, radius):
    """Returns the means over squares of half side `radius`."""
    for axis in (0, 1):
        pad = [(radius + 1, radius) if a == axis else (0, 0) for a in (0, 1)]
        total = np.cumsum(np.pad(image, pad, mode="edge"), axis=axis)
        n = image.shape[axis]
        step = 2 * radius + 1
        upper = np.take(total, range(step, step + n), axis)
        image = (upper - np.take(total, range(n), axis)) / step
    return image


def draw(bodies, view, up, width, height, bounds, disc):
    """Returns the picture of `bodies`, pairs of points and colours, seen along `view`.

    `bounds` is the least and largest position across and upwards [L], `disc` the radius of a point
    [L].
    """
    view = np.array(view, float) / np.linalg.norm(view)
    right = np.cross(view, up)
    right /= np.linalg.norm(right)
    above = np.cross(right, view)
    low, high = bounds
    w, h = SCALE * width, SCALE * height
    unit = min(w / (high[0] - low[0]), h / (high[1] - low[1]))  # samples per length
    points = np.concatenate([b[0] for b in bodies])
    colors = np.concatenate([np.broadcast_to(b[1], b[0].shape) for b in bodies]).astype(np.float32)
    middle = [(low[k] + high[k]) / 2 for k in (0, 1)]
    x = ((points @ right - middle[0]) * unit + w / 2).astype(int)
    y = (h / 2 - (points @ above - middle[1]) * unit).astype(int)
    depth = points @ view * unit
    size = max(1.0, disc * unit)
    buffer = np.full(w * h, np.inf)
    owner = np.full(w * h, -1)
    reach = int(size)
    for dx in range(-reach, reach + 1):
        for dy in range(-reach, reach + 1):
            far = (dx * dx + dy * dy) / size**2
            if far > 1:
                continue
            at = np.flatnonzero((x + dx >= 0) & (x + dx < w) & (y + dy >= 0) & (y + dy < h))
            pixel = (y[at] + dy) * w + x[at] + dx
            z = depth[at] - size * np.sqrt(1 - far)  # a ball
            order = np.lexsort((-z, pixel))
            pixel, z, at = pixel[order], z[order], at[order]
            last = np.append(pixel[1:] != pixel[:-1], True)
            pixel, z, at = pixel[last], z[last], at[last]
            nearer = z < buffer[pixel]
            buffer[pixel[nearer]] = z[nearer]
            owner[pixel[nearer]] = at[nearer]
    is_hit = (owner >= 0).reshape(h, w)
    image = np.full((h, w, 3), 255, np.float32)
    if is_hit.any():
        image[is_hit] = shade(buffer.reshape(h, w), is_hit, size)[is_hit][:, None] * (
            colors[owner[owner >= 0]]
        )
    image = image.reshape(height, SCALE, width, SCALE, 3).mean((1, 3))
    return np.clip(image, 0, 255).astype(np.uint8)


def median(image, step=2):
    """Returns the median of each sample and its eight neighbours at distance `step`."""
    padded = np.pad(image, step, mode="edge")
    h, w = image.shape
    shifts = [(a, b) for a in (0, step, 2 * step) for b in (0, step, 2 * step)]
    around = [padded[a : a + h, b : b + w] for a, b in shifts]
    return np.partition(around, 4, axis=0)[4]


def shade(depth, is_hit, size):
    """Returns the brightness of each sample."""
    back = depth[is_hit].max()
    filled = median(np.where(is_hit, depth, back))
    weight = blur(is_hit.astype(float), int(size) + 1)
    smooth = blur(np.where(is_hit, filled, 0), int(size) + 1) / np.maximum(weight, 1e-9)
    gy, gx = np.gradient(smooth)
    steep = 1 / np.sqrt(gx**2 + gy**2 + 1)
    light = np.array([-0.45, 0.62, 0.64])
    diffuse = np.clip((light[0] * gx - light[1] * gy + light[2]) * steep, 0, 1)
    open_sky = np.zeros_like(depth)
    radii = (4, 10, 24)
    for radius in radii:
        around = blur(filled, radius)
        open_sky += np.clip((filled - around) / (1.5 * radius), 0, 1) / len(radii)
    return (0.5 + 0.66 * diffuse) * (1 - 0.7 * open_sky)


def bounds_of(bodies, view, up, margin):
    view = np.array(view, float) / np.linalg.norm(view)
    right = np.cross(view, up)
    right /= np.linalg.norm(right)
    above = np.cross(right, view)
    points = np.concatenate([b[0] for b in bodies])
    across = np.column_stack([points @ right, points @ above])
    low, high = across.min(0), across.max(0)
    return low - margin * (high[1] - low[1]), high + margin * (high[1] - low[1])


def sample_triangles(points, triangles, count):
    """Returns random points on triangles, by area."""
    a, b, c = (points[triangles[:, k]] for k in (0, 1, 2))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    random = np.random.default_rng(1)
    t = random.choice(len(triangles), count, p=area / area.sum())
    s, r = np.sqrt(random.random((count, 1))), random.random((count, 1))
    return (1 - s) * a[t] + s * (1 - r) * b[t] + s * r * c[t]


def side_by_side(panels, view, up, height, disc, margin=0.03):
    """Draws every panel, a list of bodies, at the same scale.

    `disc` is the radius of points [L], or one for each panel.
    """
    discs = np.broadcast_to(disc, len(panels))
    bounds = [bounds_of(panel, view, up, margin) for panel in panels]
    low, high = min(b[0][1] for b in bounds), max(b[1][1] for b in bounds)
    images = []
    for panel, (least, largest), disc in zip(panels, bounds, discs):
        width = int(np.ceil((largest[0] - least[0]) / (high - low) * height))
        frame = (np.array([least[0], low]), np.array([largest[0], high]))
        images.append(draw(panel, view, up, width, height, frame, disc))
    return np.concatenate(images, axis=1)


def branch_colors(branch):
    """Returns a colour for each branch: the trunk brown, the others by their number."""
    hue = (branch * 0.61803398875) % 1
    wave = [np.clip(np.abs((hue * 6 + k) % 6 - 3) - 1, 0, 1) for k in (0, 4, 2)]
    colors = 84 + 150 * np.column_stack(wave)
    colors[branch == 0] = (120, 84, 58)
    colors[branch < 0] = (205, 205, 205)
    return colors


def scale_colors(value):
    """Returns colours from blue over green to yellow for values from 0 to 1."""
    stops = np.array([(68, 40, 120), (52, 104, 168), (44, 156, 140), (140, 200, 80), (250, 220, 60)])
    place = np.clip(value, 0, 1) * (len(stops) - 1)
    k = np.minimum(place.astype(int), len(stops) - 2)
    part = (place - k)[:, None]
    return (1 - part) * stops[k] + part * stops[k + 1]


# ---- pictures


def run(options, program, *arguments):
    path = os.path.join(options.programs, program)
    subprocess.run([path, *map(str, arguments)], check=True, stdout=subprocess.DEVNULL)


def picture_of_deformation(options):
    """The dragon at rest with its handles, and deformed by them."""
    points = points_of(read_ply(options.dragon)[0])
    low, high = points.min(0), points.max(0)
    size = high - low
    edit = {"handles": []}
    bodies = []
    handles = [
        ((0.0, -0.1, -0.1), (1.0, 0.10, 1.1), {"fixed": True}, HELD),
        (
            (-0.1, 0.62, -0.1),
            (0.30, 1.1, 1.1),
            {"rotate": {"axis": [0, 0, 1], "degrees": -42}, "translate": [-0.012, 0.025, 0.0]},
            MOVED,
        ),
    ]
    color = np.tile(np.array(GREY, float), (len(points), 1))
    for least, largest, motion, paint in handles:
        a, b = low + size * np.array(least), low + size * np.array(largest)
        edit["handles"].append({"select": {"box": [list(a), list(b)]}, **motion})
        color[((points >= a) & (points <= b)).all(1)] = paint
    file, result = (os.path.join(options.work, name) for name in ("edit.json", "dragon.ply"))
    with open(file, "w", encoding="ascii") as out:
        json.dump(edit, out)
    run(options, "deform_point_set", "--input", options.dragon, "--edit", file, "--output", result)
    moved = points_of(read_ply(result)[0])
    bodies = [[(points, color)], [(moved, color)]]
    return side_by_side(bodies, (0.15, -0.12, -1), (0, 1, 0), 420, 0.0011 * size[0] / 0.2)


def picture_of_skeleton(options):
    """A scan, its points coloured by branches, and the surface of the branches."""
    swc, labels, mesh = (os.path.join(options.work, n) for n in ("s.swc", "s.ply", "m.ply"))
    run(
        options, "extract_tree_skeleton", "--input", options.scan, "--swc", swc,
        "--points", labels, "--mesh", mesh,
    )  # fmt: skip
    vertices = read_ply(labels)[0]
    points = points_of(vertices)
    surface, triangles = read_ply(mesh)
    wood = sample_triangles(points_of(surface), triangles, 1500000)
    size = np.ptp(points[:, 2])
    colors = branch_colors(vertices["branch"].astype(int))
    panels = [[(points, GREY)], [(points, colors)], [(wood, (168, 132, 98))]]
    return side_by_side(panels, (0.3, 1, -0.1), (0, 0, 1), 520, 0.0012 * size)


def picture_of_geodesic(options):
    """Points on the geodesic between two scans."""
    folder = os.path.join(options.work, "geodesic")
    run(
        options, "orl_geodesic", "--tree", options.scan, "--tree", options.other_scan,
        "--lambda", "0,0.25,0.5,0.75,1", "--output", folder,
    )  # fmt: skip
    names = sorted(name for name in os.listdir(folder) if name.endswith(".ply"))
    panels = []
    for k, name in enumerate(names):
        points = points_of(read_ply(os.path.join(folder, name))[0])
        part = k / max(1, len(names) - 1)
        color = (1 - part) * np.array(FIRST) + part * np.array(SECOND)
        panels.append([(points, color)])
    size = max(np.ptp(panel[0][0][:, 2]) for panel in panels)
    return side_by_side(panels, (0.3, 1, -0.1), (0, 0, 1), 420, 0.0013 * size)


def stage(options, name):
    """Returns the points of a stage and their values."""
    vertices = read_ply(os.path.join(options.work, name + ".ply"))[0]
    return points_of(vertices), vertices["value"]


def stages_of_deformation(options):
    """Handles, samples, strained samples, and the points with their rotations."""
    paint = np.array([GREY, HELD, MOVED], float)
    panels = []
    for name in ("handles", "samples"):
        points, value = stage(options, name)
        panels.append([(points, paint[value.astype(int)])])
    points, energy = stage(options, "strained")
    panels.append([(points, scale_colors(np.sqrt(energy / np.quantile(energy, 0.98))))])
    points, angle = stage(options, "rotated")
    panels.append([(points, scale_colors(angle / angle.max()))])
    unit = np.ptp(points[:, 0]) / 0.2
    discs = [0.0011 * unit, 0.0024 * unit, 0.0024 * unit, 0.0011 * unit]
    return side_by_side(panels, (0.15, -0.12, -1), (0, 1, 0), 300, discs)


def stages_of_skeleton(options):
    """The scan, its level sets, the fitted axes, and the branches by their order."""
    scan = points_of(read_ply(options.scan)[0])
    panels, size = [[(scan, GREY)]], np.ptp(scan[:, 2])
    for name in ("level_sets", "axes"):
        points, value = stage(options, name)
        panels.append([(points, branch_colors(value.astype(int) + 1))])
    points, order = stage(options, "branches")
    paint = np.array([(120, 84, 58), (52, 104, 168), (44, 156, 140), (224, 122, 46), (150, 90, 160)])
    panels.append([(points, paint[np.minimum(order.astype(int), 4)].astype(float))])
    discs = np.array([0.0012, 0.0016, 0.0016, 0.0012]) * size
    return side_by_side(panels, (0.3, 1, -0.1), (0, 0, 1), 460, discs)


def stages_of_shape_space(options):
    """Trees on a geodesic: matched branches in the same colour, the others grey."""
    panels = []
    for quarter in range(5):
        points, branch = stage(options, f"between_{quarter}")
        panels.append([(points, branch_colors(branch.astype(int)))])
    size = max(np.ptp(panel[0][0][:, 2]) for panel in panels)
    return side_by_side(panels, (0.3, 1, -0.1), (0, 0, 1), 380, 0.0014 * size)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--programs", required=True, help="folder of the built programs")
    parser.add_argument("--work", required=True, help="folder for results of the programs")
    parser.add_argument("--dragon", help="the dragon of the Stanford 3D Scanning Repository")
    parser.add_argument("--scan", help="scan of a tree without leaves")
    parser.add_argument("--other-scan", help="scan of another tree, for the geodesic")
    parser.add_argument("--output", default=FIGURES, help="folder of the pictures")
    parser.add_argument("--stages", help="the program write_stages")
    options = parser.parse_args()
    os.makedirs(options.work, exist_ok=True)
    if options.dragon:
        picture = picture_of_deformation(options)
        write_png(os.path.join(options.output, "deform_point_set.png"), picture)
    if options.scan:
        picture = picture_of_skeleton(options)
        write_png(os.path.join(options.output, "extract_tree_skeleton.png"), picture)
    if options.scan and options.other_scan:
        picture = picture_of_geodesic(options)
        write_png(os.path.join(options.output, "orl_geodesic.png"), picture)
    if options.dragon and options.scan and options.stages:
        subprocess.run([options.stages, options.dragon, options.scan, options.work], check=True)
        for name in ("deformation", "skeleton", "shape_space"):
            picture = globals()["stages_of_" + name](options)
            write_png(os.path.join(options.output, "stages_" + name + ".png"), picture)


if __name__ == "__main__":
    main()
