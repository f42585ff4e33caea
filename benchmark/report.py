#!/usr/bin/env python3
# Copyright (c) 2026 The pcs authors
# SPDX-License-Identifier: BSL-1.0
"""Runs the benchmarks, and writes their tables and plots as one HTML page and as JSON.

    benchmark/report.py --programs build/bench/benchmark --output build/bench/report [--data DIR]

Figures of other programs that were recorded elsewhere are added by --recorded FILE.csv, with the
columns program, quantity, value, source, date. Needs Python 3 without further packages.
"""

import argparse
import csv
import datetime
import html
import json
import math
import os
import platform
import subprocess
import sys
import time

# title, program and arguments; {data} is replaced by the folder of --data, {most} by --most
RUNS = [
    ("Growth with the number of points", "bench_scaling", ["--most", "{most}"]),
    ("Deformation: table 2.1", "bench_deform_table_2_1", ["--data", "{data}"]),
    ("Deformation: all points as samples, beside CGAL", "bench_full_resolution", []),
    ("Deformation: known answers, beside CGAL", "bench_deformation_quality", ["--peers"]),
    ("Deformation: linear solvers, beside Eigen and CHOLMOD", "bench_linear_solvers", []),
    ("Deformation: graphs, beside Boost.Graph", "bench_graphs", []),
    ("Deformation: neighbour links", "bench_neighbor_links", []),
    ("Nonrigid registration", "bench_fit_point_set", ["--data", "{data}"]),
    ("Gaussian splats", "bench_splats", []),
    ("Skeletons: time by stage", "bench_skeleton", []),
    ("Skeletons: steps beside the published ones", "bench_skeleton_ablation", []),
    ("Skeletons: standard errors", "bench_standard_errors", ["--trees", "5"]),
    ("Growth parameters of known habits", "bench_tree_habit", ["--habits", "5"]),
    ("Stands: slopes and thin ground", "evaluate_stands", ["--stands", "1"]),
    ("Virtual scanner", "bench_scan_tree", []),
]
COLUMNS = ("program", "quantity", "value", "source", "date")  # of --recorded
QUICK = ("bench_scaling", "bench_full_resolution", "bench_skeleton", "bench_scan_tree")
COLORS = ("#1f6fb4", "#d9822b", "#3a8f4d", "#a14c9b", "#b03a3a", "#5f6b76")

STYLE = """
:root { color-scheme: light dark; --line: #8884; --faint: #8882; }
body { font: 16px/1.5 system-ui, sans-serif; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; }
table { border-collapse: collapse; font-size: 0.85rem; display: block; overflow-x: auto; }
th, td { border-bottom: 1px solid var(--line); padding: 0.25rem 0.6rem; text-align: left; }
th { background: var(--faint); }
svg { max-width: 100%; height: auto; }
svg text { font: 12px system-ui, sans-serif; fill: currentColor; }
pre { background: var(--faint); padding: 0.5rem; overflow-x: auto; font-size: 0.85rem; }
"""


def output_of(command):
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def environment(programs):
    """Returns what the times depend on."""
    cpu = "unknown"
    if os.path.exists("/proc/cpuinfo"):
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            names = [line.split(":")[1].strip() for line in file if line.startswith("model name")]
        cpu = names[0] if names else cpu
    compiler, cache = "unknown", os.path.join(programs, "..", "CMakeCache.txt")
    if os.path.exists(cache):
        with open(cache, encoding="utf-8") as file:
            values = dict(line.strip().split("=", 1) for line in file if "=" in line)
        path = values.get("CMAKE_CXX_COMPILER:FILEPATH") or values.get("CMAKE_CXX_COMPILER:STRING")
        compiler = output_of([path, "--version"]).split("\n")[0] if path else compiler
    here = os.path.dirname(os.path.abspath(__file__))
    return {
        "date": datetime.date.today().isoformat(),
        "commit": output_of(["git", "-C", here, "rev-parse", "--short=12", "HEAD"]),
        "processor": f"{cpu}, {os.cpu_count()} threads",
        "system": platform.platform(),
        "compiler": compiler,
        "load": " ".join(f"{x:.1f}" for x in os.getloadavg()),
    }


def tables_of(text):
    """Returns the Markdown tables of a text, each as a list of rows, and the other lines."""
    tables, rest, rows = [], [], []
    for line in text.split("\n") + [""]:
        if line.startswith("|"):
            rows.append([cell.strip() for cell in line.strip().strip("|").split("|")])
        else:
            if rows:
                tables.append([row for k, row in enumerate(rows) if k != 1])
                rows = []
            if line.strip():
                rest.append(line)
    return tables, rest


def run(title, program, arguments, options):
    """Runs one program; returns its result, or why there is none."""
    result = {"title": title, "program": program, "arguments": arguments}
    path = os.path.join(options.programs, program)
    if not os.path.exists(path):
        return {**result, "error": "the program was not built"}
    print(f"{program} {' '.join(arguments)}", file=sys.stderr, flush=True)
    start = time.time()
    try:
        done = subprocess.run(
            [path, *arguments], capture_output=True, text=True, errors="replace",
            timeout=options.limit, check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return {**result, "error": f"stopped after {options.limit:g} s (--limit)"}
    except OSError as error:
        return {**result, "error": f"could not be started: {error.strerror}"}
    tables, rest = tables_of(done.stdout)
    result.update(seconds=round(time.time() - start, 1), tables=tables, text=rest)
    if done.returncode != 0:
        lines = done.stderr.strip().split("\n")
        result["error"] = f"exit code {done.returncode}: {lines[-1]}"
    return result


# ---- HTML


def html_table(rows):
    head = "".join(f"<th scope='col'>{html.escape(cell)}</th>" for cell in rows[0])
    body = "".join(
        "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>"
        for row in rows[1:]
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def log_plot(series, x_label, y_label):
    """Returns an SVG with a line for each name in `series`, a dictionary of lists of (x, y)."""
    values = [p for line in series.values() for p in line if p[0] > 0 and p[1] > 0]
    if len(values) < 2:
        return ""
    width, height, left, low = 760, 420, 70, 370
    spans = []
    for k in (0, 1):
        logs = [math.log10(p[k]) for p in values]
        spans.append((math.floor(min(logs)), max(math.ceil(max(logs)), math.floor(min(logs)) + 1)))

    def place(x, y):
        part = [(math.log10(v) - s[0]) / (s[1] - s[0]) for v, s in zip((x, y), spans)]
        return left + part[0] * 420, low - part[1] * (low - 20)

    parts = [f"<svg viewBox='0 0 {width} {height}' role='img' aria-label='{y_label} by {x_label}'>"]
    for power in range(spans[0][0], spans[0][1] + 1):
        x, _ = place(10**power, 10 ** spans[1][0])
        parts.append(f"<path d='M{x:.1f} 20V{low}' stroke='#8884'/>")
        parts.append(f"<text x='{x:.1f}' y='{low + 18}' text-anchor='middle'>1e{power}</text>")
    for power in range(spans[1][0], spans[1][1] + 1):
        _, y = place(10 ** spans[0][0], 10**power)
        parts.append(f"<path d='M{left} {y:.1f}H{left + 420}' stroke='#8884'/>")
        parts.append(f"<text x='{left - 8}' y='{y + 4:.1f}' text-anchor='end'>1e{power}</text>")
    for k, (name, line) in enumerate(series.items()):
        color = COLORS[k % len(COLORS)]
        dots = [place(*p) for p in line if p[0] > 0 and p[1] > 0]
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in dots)
        parts.append(f"<polyline points='{path}' fill='none' stroke='{color}' stroke-width='2'/>")
        parts.extend(f"<circle cx='{x:.1f}' cy='{y:.1f}' r='3' fill='{color}'/>" for x, y in dots)
        y = 30 + 22 * k
        parts.append(f"<rect x='{left + 440}' y='{y - 9}' width='12' height='4' fill='{color}'/>")
        parts.append(f"<text x='{left + 458}' y='{y}'>{html.escape(name)}</text>")
    parts.append(f"<text x='{left + 210}' y='{height - 8}' text-anchor='middle'>{x_label}</text>")
    parts.append(f"<text x='{left}' y='12'>{y_label}</text></svg>")
    return "".join(parts)


def scaling_plot(table):
    """Returns the plot of the table of bench_scaling, with the time of the queries as a line."""
    series = {}
    for row in table[1:]:
        try:
            name, (points, seconds, query) = row[0], map(float, row[1:4])
        except ValueError:
            continue  # a value is missing
        if not all(0 < x < math.inf for x in (points, seconds, query)):
            continue
        series.setdefault(name, []).append((points, seconds))
        label = "query of 6 neighbours" if "deformation" in name else "query of 25 neighbours"
        line = series.setdefault(label, [])
        if all(x != points for x, _ in line):
            line.append((points, query))
    return log_plot({k: sorted(v) for k, v in series.items()}, "points", "seconds")


def page(report):
    parts = ["<!doctype html><html lang='en'><head><meta charset='utf-8'>"]
    parts.append("<meta name='viewport' content='width=device-width'>")
    parts.append("<title>pcs: benchmarks</title>")
    parts.append(f"<style>{STYLE}</style></head><body><h1>pcs: benchmarks</h1>")
    parts.append(
        "<p>Seconds depend on the machine and on what else runs on it. Compare ratios: reference"
        " computations are timed in the same process.</p>"
    )
    parts.append(html_table([["", ""]] + [[k, str(v)] for k, v in report["environment"].items()]))
    parts.append("<ul>")
    for k, result in enumerate(report["results"]):
        parts.append(f"<li><a href='#r{k}'>{html.escape(result['title'])}</a></li>")
    parts.append("</ul>")
    for k, result in enumerate(report["results"]):
        parts.append(f"<h2 id='r{k}'>{html.escape(result['title'])}</h2>")
        command = " ".join([result["program"], *result["arguments"]])
        parts.append(f"<pre>{html.escape(command)}</pre>")
        if "error" in result:
            parts.append(f"<p>{html.escape(result['error'])}</p>")
        for table in result.get("tables", []):
            if result["program"] == "bench_scaling":
                parts.append(scaling_plot(table))
            parts.append(html_table(table))
        if result.get("text"):
            parts.append(f"<pre>{html.escape(chr(10).join(result['text']))}</pre>")
    if report["recorded"]:
        parts.append("<h2>Recorded figures of other programs</h2>")
        parts.append("<p>These figures were not measured in this run.</p>")
        rows = [[row[c] or "" for c in COLUMNS] for row in report["recorded"]]
        parts.append(html_table([list(COLUMNS)] + rows))
    parts.append("</body></html>")
    return "".join(parts)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--programs", required=True, help="folder of the built benchmarks")
    parser.add_argument("--output", required=True, help="folder of report.html and report.json")
    parser.add_argument("--data", default="build/data", help="folder of the scans of table 2.1")
    parser.add_argument("--most", default="1000000", help="largest cloud of the growth of time")
    parser.add_argument("--limit", type=float, default=1800, help="seconds for each program")
    parser.add_argument("--quick", action="store_true", help="only a few programs")
    parser.add_argument("--recorded", help="figures of other programs (CSV)")
    options = parser.parse_args()
    if not os.path.isdir(options.programs):
        parser.error(f"--programs {options.programs} is no folder; ./run bench builds the programs")
    if not options.limit > 0:
        parser.error("--limit must be more than 0")
    recorded = []
    try:
        if options.recorded:
            with open(options.recorded, encoding="utf-8", newline="") as file:
                recorded = list(csv.DictReader(file))
        os.makedirs(options.output, exist_ok=True)
    except (OSError, UnicodeDecodeError) as error:
        parser.error(str(error))
    if recorded and not set(COLUMNS) <= set(recorded[0]):
        parser.error(f"--recorded needs the columns {', '.join(COLUMNS)}")
    report = {"environment": environment(options.programs), "results": [], "recorded": recorded}
    for title, program, arguments in RUNS:
        if options.quick and program not in QUICK:
            continue
        known = {"data": options.data, "most": options.most}
        filled = [argument.format(**known) for argument in arguments]
        report["results"].append(run(title, program, filled, options))
        # after every program, so that an interruption loses nothing
        for name, text in (("json", json.dumps(report, indent=1)), ("html", page(report))):
            path = os.path.join(options.output, "report." + name)
            with open(path + ".part", "w", encoding="utf-8") as file:
                file.write(text)
            os.replace(path + ".part", path)
    print(os.path.join(options.output, "report.html"))
    return 0 if all("error" not in result for result in report["results"]) else 1


if __name__ == "__main__":
    sys.exit(main())
