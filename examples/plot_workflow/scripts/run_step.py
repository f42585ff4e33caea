#!/usr/bin/env python3
# Copyright (c) 2026 The pcs authors
# SPDX-License-Identifier: BSL-1.0
"""Runs one step of the plot workflow and records whether it has failed.

A failure is written to the status file of the step, so the other steps go on. The exit code is 1
only if the step shall be started again, or if nothing can go on without it.
"""

import argparse
import csv
import ctypes
import fcntl
import filecmp
import json
import math
import os
import shutil
import signal
import subprocess
import sys
import time

TREE_COLUMNS = (
    "tree,x,y,z,radius,diameter_at_breast_height,height,points,tile,parts,is_at_rim,cut_parts,file,"
    "crown_area,crown_volume"
)
BAD_INPUT = 1  # exit code of the programs: another attempt has the same result
INCOMPLETE = 3  # exit code of tile_points: damaged scans are left out and listed in tiles.json


class Again(Exception):
    """The program ended for a reason that more memory or time may remove."""


def write(path, text):
    """Writes a file that is complete or absent."""
    if os.path.dirname(path):
        os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path + ".incomplete", "w", encoding="utf-8", newline="") as file:
        file.write(text)
    os.replace(path + ".incomplete", path)


def write_json(path, content):
    write(path, json.dumps(content, indent=1) + "\n")


def remove(path):
    if os.path.isdir(path):
        shutil.rmtree(path)
    elif os.path.lexists(path):
        os.remove(path)


class Runner:
    """Runs programs within the limits of the step and appends what they print to the log."""

    def __init__(self, arguments):
        self.arguments = arguments
        self.process = None
        os.makedirs(os.path.dirname(arguments.log) or ".", exist_ok=True)
        # If Snakemake was killed, this step may still run: its files are written by one process.
        os.makedirs("locks", exist_ok=True)
        name = arguments.step + "_" + os.path.basename(arguments.log)
        self.lock = open(os.path.join("locks", name), "w", encoding="ascii")
        fcntl.flock(self.lock, fcntl.LOCK_EX)
        for number in (signal.SIGTERM, signal.SIGINT):
            signal.signal(number, self.stop)

    def stop(self, number, _):
        """The run is cancelled: nothing is recorded, the next run repeats the step."""
        if self.process:
            self.process.kill()
        os._exit(128 + number)

    def prepare(self):
        """Called in the process of the program, which ends when this process is killed."""
        try:
            ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # PR_SET_PDEATHSIG, on Linux only
        except (OSError, AttributeError):
            pass

    def wait(self, seconds):
        """Ends the program at its limits. Returns the exit code and the limit that was exceeded.

        Memory is what is resident: the address space is several times as large.
        """
        end = time.monotonic() + seconds if seconds else math.inf
        while True:
            try:
                return self.process.wait(timeout=0.2), ""
            except subprocess.TimeoutExpired:
                limit = ""
            if self.arguments.memory_mb and self.resident_mb() > self.arguments.memory_mb:
                limit = f"needs more memory than {self.arguments.memory_mb} MB"
            elif time.monotonic() > end:
                limit = f"needs more time than {self.arguments.minutes} minutes"
            if limit:
                self.process.kill()
                return self.process.wait(), limit

    def resident_mb(self):
        """Resident memory of the program; 0 on systems without /proc."""
        try:
            with open(f"/proc/{self.process.pid}/statm", encoding="ascii") as file:
                return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
        except (OSError, ValueError, IndexError):
            return 0

    def run(self, command, is_last=None):
        """Returns the exit code and the message; raises `Again` before the last attempt."""
        if is_last is None:
            is_last = self.arguments.attempt >= self.arguments.attempts
        seconds = 60 * self.arguments.minutes if self.arguments.minutes else None
        if seconds:  # before the limit of a batch system, which would end this process
            seconds -= min(30, seconds / 10)
        with open(self.arguments.log, "ab+") as log:
            start = log.seek(0, os.SEEK_END)
            try:
                self.process = subprocess.Popen(
                    command,
                    stdin=subprocess.DEVNULL,
                    stdout=log,
                    stderr=log,
                    preexec_fn=self.prepare,
                )
                code, limit = self.wait(seconds)
            except OSError as error:
                text = f"{command[0]}: cannot be started: {error.strerror}; see `programs`"
                text += " in config.yaml"
                log.write(text.encode() + b"\n")
                return BAD_INPUT, text
            if limit:
                log.write(f"{os.path.basename(command[0])}: {limit}\n".encode())
            log.seek(start)
            lines = log.read().decode(errors="replace").splitlines()
        lines = [line for line in lines if line.strip() and ": warning: " not in line]
        message = " ".join(lines[-3:])
        if code < 0 and not limit:
            limit = f"ended by signal {-code}"
            message = f"{message} {os.path.basename(command[0])}: {limit}".strip()
        if code not in (0, BAD_INPUT, INCOMPLETE) and not is_last:
            raise Again(message)
        return code, message


def cut(arguments, runner):
    """Tiles of an earlier run are replaced only by a complete set."""
    remove("tiles.incomplete")
    code, message = runner.run(arguments.command + ["--folder", "tiles.incomplete", "--quiet"])
    if code not in (0, INCOMPLETE):
        remove("tiles.incomplete")
        sys.exit(f"{message}\nWithout tiles, no other step can run.")
    remove(arguments.folder)
    os.rename("tiles.incomplete", arguments.folder)


def segment(arguments, runner):
    name = os.path.splitext(os.path.basename(arguments.tile))[0]
    for extension in (".json", ".ply"):
        remove(os.path.join(arguments.folder, name + extension))
    code, message = runner.run(
        arguments.command + ["--input", arguments.tile, "--tile-results", arguments.folder]
    )
    failures = [{"step": "segment", "name": name, "message": message}] if code != 0 else []
    write_json(arguments.status, {"failures": failures})


def merge(arguments, runner):
    new = arguments.folder + ".incomplete"
    remove(new)
    os.makedirs(new)
    paths = {
        "--table": "trees.csv",
        "--points": arguments.labels,
        "--folder": "trees",
        "--crowns": "crowns.geojson",
        "--report": "merge.json",
    }
    outputs = [word for key in paths for word in (key, os.path.join(new, paths[key]))]
    code, message = runner.run(arguments.command + outputs)
    failures, report = [], {}
    table = os.path.join(new, "trees.csv")
    try:  # the exit code is 1, too, if a tile is missing, which has its own record
        with open(os.path.join(new, "merge.json"), encoding="utf-8") as file:
            report = json.load(file)
        if not os.path.exists(table):
            raise OSError
    except (OSError, ValueError):
        report = {}
        failures = [{"step": "merge", "name": "plot", "message": message or f"exit code {code}"}]
        remove(new)
        os.makedirs(new)
        write(table, TREE_COLUMNS + "\n")
    keep_times(os.path.join(arguments.folder, "trees"), os.path.join(new, "trees"))
    remove(arguments.folder)
    os.rename(new, arguments.folder)
    kept = {key: report.get(key, []) for key in ("warnings", "close_feet")}
    write_json(arguments.status, {"failures": failures, **kept})


def keep_times(old, new):
    """Equal trees keep their time, so their skeletons are not computed again."""
    for name in os.listdir(new) if os.path.isdir(new) else []:
        before, after = os.path.join(old, name), os.path.join(new, name)
        if os.path.exists(before) and filecmp.cmp(before, after, shallow=False):
            times = os.stat(before)
            os.utime(after, ns=(times.st_atime_ns, times.st_mtime_ns))


def read_batch(folder, start=0):
    """Returns the last line of each tree from a position of the log on, and the end of the log."""
    path = os.path.join(folder, "batch.jsonl")
    entries = {}
    if not os.path.exists(path):
        return entries, 0
    with open(path, "rb") as file:
        file.seek(start)
        for line in file.read().splitlines():
            try:
                entry = json.loads(line)
                entries[entry["input"]] = entry
            except (ValueError, KeyError, TypeError):
                pass  # torn by a program that was killed
        return entries, file.tell()


def remove_foreign(folder, trees):
    """Removes results of trees that belong to another group since the tiles were merged again."""
    stems = [os.path.splitext(os.path.basename(tree))[0] for tree in trees]
    for name in os.listdir(folder) if os.path.isdir(folder) else []:
        if name.startswith("tree_") and not any(name.startswith(stem) for stem in stems):
            remove(os.path.join(folder, name))


def skeletons_of(trees, arguments, runner, is_last=None):
    """Returns the report, or the message of a failure, of each tree."""
    _, start = read_batch(arguments.folder)
    code, message = runner.run(
        arguments.command + ["--input", *trees, "--folder", arguments.folder], is_last
    )
    entries, _ = read_batch(arguments.folder)
    fresh, _ = read_batch(arguments.folder, start)
    is_batch = code == 0 or any("error" in entry for entry in fresh.values())
    if code not in (0, BAD_INPUT) or not is_batch:  # the end was not reached
        if len(trees) == 1 or code == BAD_INPUT:
            return {tree: {"error": message or f"exit code {code}"} for tree in trees}
        results = {}
        for tree in trees:  # only the one at fault is lost
            results.update(skeletons_of([tree], arguments, runner, True))
        return results
    return {tree: entries.get(tree, {"error": message}) for tree in trees}


def skeletons(arguments, runner):
    remove_foreign(arguments.folder, arguments.trees)
    is_last = arguments.attempt >= arguments.attempts
    results = skeletons_of(arguments.trees, arguments, runner, is_last)
    reports, failures = {}, []
    for tree, entry in results.items():
        name = os.path.basename(tree)
        if "error" in entry:
            failures.append({"step": "skeleton", "name": name, "message": entry["error"]})
            continue
        errors = entry.get("standard_errors", {})
        reports[name] = {
            "diameter_at_breast_height": entry["diameter_at_breast_height"],
            "height": entry["height"],
            "volume": entry["volume"],
            "standard_errors": {
                key: errors.get(key) for key in ("diameter_at_breast_height", "height", "volume")
            },
            "warnings": entry["warnings"],
        }
    write_json(arguments.status, {"failures": failures, "trees": reports})


def check(arguments):
    with open(arguments.failures, newline="", encoding="utf-8") as file:
        failures = list(csv.DictReader(file))
    if not failures:
        return
    for failure in failures[:10]:
        print("{step} {name}: {message}".format(**failure), file=sys.stderr)
    steps = {failure["step"] for failure in failures}
    if "merge" in steps:
        state = "no tiles could be merged, so the tables and the map have no trees"
    elif steps & {"tile", "segment"}:
        state = (
            "trees with points in these scans or tiles are missing or cut; the warnings of "
            "trees.csv name them; all other results are complete"
        )
    else:
        state = "all other results are complete"
    sys.exit(
        f"{len(failures)} failure(s) are listed in {arguments.failures}; {state}. Remove the "
        "cause, run `snakemake repeat_failures`, and start the run again."
    )


def forget(arguments):
    """Removes the status files with failures, and what depends on them; the next run makes both."""
    count = 0
    for folder, _, names in os.walk(arguments.status):
        for name in sorted(names):
            path = os.path.join(folder, name)
            with open(path, encoding="utf-8") as file:
                if not json.load(file)["failures"]:
                    continue
            count += 1
            remove(path)
            if os.path.basename(folder) == "segment":
                remove(os.path.join(arguments.status, "merge.json"))
            remove(arguments.failures)  # Snakemake makes missing inputs only of what is missing
    try:
        with open(arguments.tiles, encoding="utf-8") as file:
            has_skipped = bool(json.load(file).get("skipped"))
    except OSError:
        has_skipped = False
    if has_skipped:
        count += 1
        remove(arguments.tiles)
        remove(arguments.failures)
    print(f"{count} step(s) will be repeated")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("step", choices="tile segment merge skeletons check forget".split())
    parser.add_argument("--folder", help="folder of the results")
    parser.add_argument("--tile", help="segment: the tile")
    parser.add_argument("--trees", nargs="*", help="skeletons: the files of the trees")
    parser.add_argument("--labels", help="merge: name of the file of all points")
    parser.add_argument("--status", help="status file to write; forget: their folder")
    parser.add_argument("--failures", help="the table of failures")
    parser.add_argument("--tiles", help="forget: the manifest of the tiles")
    parser.add_argument("--log", help="what the program prints is appended here")
    parser.add_argument("--memory-mb", type=int, default=0, help="limit of the memory; 0: none")
    parser.add_argument("--minutes", type=int, default=0, help="limit of the time; 0: none")
    parser.add_argument("--attempt", type=int, default=1)
    parser.add_argument("--attempts", type=int, default=1)
    words = sys.argv[1:]
    at = words.index("--") if "--" in words else len(words)
    arguments = parser.parse_args(words[:at])
    arguments.command = words[at + 1 :]
    if arguments.step in ("check", "forget"):
        {"check": check, "forget": forget}[arguments.step](arguments)
        return
    steps = {"tile": cut, "segment": segment, "merge": merge, "skeletons": skeletons}
    try:
        steps[arguments.step](arguments, Runner(arguments))
    except Again as reason:
        sys.exit(f"{reason}\nThe step is started again with twice the memory and time.")


if __name__ == "__main__":
    main()
