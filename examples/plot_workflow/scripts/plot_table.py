#!/usr/bin/env python3
# Copyright (c) 2026 The pcs authors
# SPDX-License-Identifier: BSL-1.0
"""Writes the table of a plot (CSV and GeoJSON), the table of failures, and the map (SVG)."""

import argparse
import csv
import io
import json
import os
import sys
from xml.sax.saxutils import escape

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from run_step import write  # noqa: E402

COLUMNS = (
    "tree x y foot_height dbh dbh_error height height_error wood_volume wood_volume_error"
    " crown_area crown_volume scan_dbh scan_height points tile state warnings"
).split()


def read_json(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def rounded(value, digits):
    return None if value is None else round(float(value), digits)


def row_of(tree, reports, errors, close, lost, skipped):
    """One row: what is not known is None."""
    row = dict.fromkeys(COLUMNS)
    row.update(
        tree=int(tree["tree"]),
        x=rounded(tree["x"], 3),
        y=rounded(tree["y"], 3),
        foot_height=rounded(tree["z"], 3),
        scan_dbh=rounded(tree["diameter_at_breast_height"], 4) or None,  # 0: not measured
        scan_height=rounded(tree["height"], 3),
        crown_area=rounded(tree["crown_area"], 3),
        crown_volume=rounded(tree["crown_volume"], 3),
        points=int(tree["points"]),
        tile=tree["tile"],
    )
    warnings = [tree["warnings"]] if tree["warnings"] else []  # of segment_trees
    report = reports.get(tree["file"])
    if report:
        error = report["standard_errors"]
        row.update(
            dbh=rounded(report["diameter_at_breast_height"], 4),
            dbh_error=rounded(error["diameter_at_breast_height"], 4),
            height=rounded(report["height"], 3),
            height_error=rounded(error["height"], 3),
            wood_volume=rounded(report["volume"], 5),
            wood_volume_error=rounded(error["volume"], 5),
        )
        if row["dbh"] is None:
            row["dbh_error"] = None
        row["state"] = "complete"
        warnings += report["warnings"]
    elif not tree["file"]:
        row["state"] = "too few points"
    else:
        row["state"] = "failed"
        warnings.append(errors.get(tree["file"], "no skeleton"))
    if tree["is_at_rim"] != "0" or tree["cut_parts"] != "0":
        warnings.append("touches the outer rim of the buffer of a tile; use a larger --buffer")
    for name, box in lost.items():
        if all(box["low"][k] <= float(tree["xy"[k]]) < box["high"][k] for k in (0, 1)):
            warnings.append(f"{name} nearby has failed; points of the tree may be missing")
    for scan in skipped:
        warnings.append(f"the plot is incomplete: the damaged scan {scan} is left out")
    for other in sorted(close.get(row["tree"], ())):
        warnings.append(f"the foot is close to that of tree {other}: perhaps one tree at a border")
    row["warnings"] = "; ".join(warnings)
    return row


def csv_text(columns, rows):
    text = io.StringIO()
    writer = csv.DictWriter(text, columns, lineterminator="\n")
    writer.writeheader()
    writer.writerows({k: "" if v is None else v for k, v in row.items()} for row in rows)
    return text.getvalue()


def collection(epsg):
    """An empty GeoJSON file. Coordinates are those of the scan; GDAL and QGIS read `crs`."""
    plot = {"type": "FeatureCollection"}
    if epsg:
        name = f"urn:ogc:def:crs:EPSG::{epsg}"
        plot["crs"] = {"type": "name", "properties": {"name": name}}
    return plot


def geojson_text(rows, failures, warnings, epsg):
    plot = collection(epsg)
    plot["failures"] = failures
    plot["warnings"] = warnings
    plot["features"] = [
        {
            "type": "Feature",
            "id": row["tree"],
            "geometry": {"type": "Point", "coordinates": [row["x"], row["y"], row["foot_height"]]},
            "properties": {k: v for k, v in row.items() if k not in ("x", "y")},
        }
        for row in rows
    ]
    return json.dumps(plot, indent=1, ensure_ascii=False) + "\n"


def crowns_text(crowns, epsg):
    """The outlines of the crowns as polygons."""
    plot = collection(epsg)
    plot["features"] = crowns
    return json.dumps(plot, indent=1) + "\n"


def map_text(rows, tiles, failed, crowns):
    """Stems to scale with their numbers, crowns, cores of tiles; red: no skeleton or no result."""
    low = [min(t["core"]["low"][k] for t in tiles) for k in (0, 1)]
    high = [max(t["core"]["high"][k] for t in tiles) for k in (0, 1)]
    size = [high[k] - low[k] for k in (0, 1)]
    # The largest usual scale, at most 1 : 100, at which the map fits on a sheet of 800 mm.
    scales = [n * 10**e for e in range(1, 7) for n in (1, 2, 5)]
    scale = next((s for s in scales if s >= 100 and max(size) * 1000 / s <= 800), scales[-1])
    mm = 1000 / scale  # of one metre
    edge, foot = 8, 14
    width, height = size[0] * mm + 2 * edge, size[1] * mm + edge + foot

    def x_of(x):
        return f"{edge + (x - low[0]) * mm:.3f}"

    def y_of(y):
        return f"{edge + (high[1] - y) * mm:.3f}"

    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.3f}mm" height="{height:.3f}mm"'
        f' viewBox="0 0 {width:.3f} {height:.3f}" font-family="sans-serif" font-size="3">',
        '<rect width="100%" height="100%" fill="white"/>',
    ]
    for tile in tiles:
        box, name = tile["core"], os.path.splitext(tile["file"])[0]
        is_failed = name in failed
        lines.append(
            f'<rect x="{x_of(box["low"][0])}" y="{y_of(box["high"][1])}"'
            f' width="{(box["high"][0] - box["low"][0]) * mm:.3f}"'
            f' height="{(box["high"][1] - box["low"][1]) * mm:.3f}"'
            f' fill="{"mistyrose" if is_failed else "none"}" stroke="silver" stroke-width="0.15">'
            f"<title>{escape(name)}{': failed' if is_failed else ''}</title></rect>"
        )
    for crown in crowns:
        if crown["geometry"]:
            corners = " ".join(
                f"{x_of(x)},{y_of(y)}" for x, y in crown["geometry"]["coordinates"][0][:-1]
            )
            label = "crown of tree {tree}: {crown_area:.1f} m²".format(**crown["properties"])
            lines.append(
                f'<polygon points="{corners}" fill="forestgreen" fill-opacity="0.15"'
                f' stroke="forestgreen" stroke-width="0.15"><title>{label}</title></polygon>'
            )
    for row in rows:
        diameter = row["dbh"] or row["scan_dbh"]
        colour = "saddlebrown" if row["state"] == "complete" else "red"
        radius = (diameter or 0.1) * mm / 2  # an open circle of 10 cm if it is not known
        fill = colour if diameter else "none"
        label = f"tree {row['tree']}: {row['state']}"
        if row["height"] is not None:
            label += f", height {row['height']} m"
        lines.append(
            f'<circle cx="{x_of(row["x"])}" cy="{y_of(row["y"])}" r="{radius:.3f}" fill="{fill}"'
            f' stroke="{colour}" stroke-width="0.1"><title>{escape(label)}</title></circle>'
        )
        lines.append(
            f'<text x="{float(x_of(row["x"])) + radius + 0.6:.3f}"'
            f' y="{float(y_of(row["y"])) + 0.9:.3f}">{row["tree"]}</text>'
        )
    bar = next(b for b in (s / 100 for s in reversed(scales)) if b * mm <= max(size) * mm / 3)
    y = height - 5
    lines += [
        f'<path d="M {edge} {y:.3f} h {bar * mm:.3f}" stroke="black" stroke-width="0.5"/>',
        f'<text x="{edge}" y="{y - 1.2:.3f}">{bar:g} m, 1 : {scale}</text>',
        "</svg>",
    ]
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tiles", required=True, help="manifest of the tiles")
    parser.add_argument("--trees", required=True, help="table of merge_tiles")
    parser.add_argument("--crowns", required=True, help="outlines of merge_tiles; may be missing")
    parser.add_argument("--status", required=True, help="folder of the status files")
    parser.add_argument("--groups", required=True, type=int, help="number of groups of trees")
    parser.add_argument("--folder", required=True, help="folder of the results")
    parser.add_argument("--epsg", type=int, help="code of the coordinate system")
    arguments = parser.parse_args()

    manifest = read_json(arguments.tiles)
    tiles, skipped = manifest["tiles"], manifest.get("skipped", [])
    names = [os.path.splitext(tile["file"])[0] for tile in tiles]
    failures = [
        {"step": "tile", "name": scan["file"], "message": scan["reason"]} for scan in skipped
    ]
    for name in names:
        status = read_json(os.path.join(arguments.status, "segment", name + ".json"))
        failures += status["failures"]
    failed_tiles = {f["name"] for f in failures if f["step"] == "segment"}
    lost = {t["file"][:-4]: t["buffered"] for t in tiles if t["file"][:-4] in failed_tiles}
    merged = read_json(os.path.join(arguments.status, "merge.json"))
    failures += merged["failures"]
    close = {}
    for one, other in merged["close_feet"]:
        close.setdefault(one, set()).add(other)
        close.setdefault(other, set()).add(one)
    reports, errors = {}, {}
    for number in range(1, arguments.groups + 1):
        status = read_json(os.path.join(arguments.status, "skeletons", f"{number:04d}.json"))
        reports.update(status["trees"])
        failures += status["failures"]
        errors.update((failure["name"], failure["message"]) for failure in status["failures"])
    with open(arguments.trees, newline="", encoding="utf-8") as file:
        rows = [
            row_of(tree, reports, errors, close, lost, [scan["file"] for scan in skipped])
            for tree in csv.DictReader(file)
        ]

    crowns = []
    if os.path.exists(arguments.crowns):  # not if the tiles could not be merged
        crowns = read_json(arguments.crowns)["features"]
    texts = {
        "trees.csv": csv_text(COLUMNS, rows),
        "trees.geojson": geojson_text(rows, failures, merged["warnings"], arguments.epsg),
        "crowns.geojson": crowns_text(crowns, arguments.epsg),
        "map.svg": map_text(rows, tiles, failed_tiles, crowns),
        "failures.csv": csv_text(["step", "name", "message"], failures),
    }
    for name, text in texts.items():
        write(os.path.join(arguments.folder, name), text)


if __name__ == "__main__":
    main()
