#!/usr/bin/env python3
# Copyright (c) 2026 The pcs authors
# SPDX-License-Identifier: BSL-1.0
"""Prints the state of a Slurm job for Snakemake: running, success or failed."""

import re
import subprocess
import sys
import time

WAITING = {"PENDING", "CONFIGURING", "RUNNING", "SUSPENDED", "COMPLETING", "REQUEUED", "RESIZING"}


def ask(*command):
    try:
        answer = subprocess.run(command, capture_output=True, text=True, timeout=60)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return answer.stdout if answer.returncode == 0 else ""


def state_of(job):
    """Returns the state, or an empty text if Slurm does not know the job."""
    found = re.search(r"\bJobState=(\w+)", ask("scontrol", "show", "job", "--oneliner", job))
    if found:
        return found.group(1)
    # scontrol forgets jobs after some minutes; sacct needs accounting.
    words = ask("sacct", "--jobs", job, "--allocations", "--noheader", "--format=State").split()
    return words[0] if words else ""


def main():
    job = sys.argv[1].split(";")[0]  # "number;cluster" on clusters of clusters
    state = ""
    for wait in (0, 5, 20):
        time.sleep(wait)
        state = state_of(job)
        if state:
            break
    if state in WAITING:
        print("running")
    else:
        print("success" if state == "COMPLETED" else "failed")


if __name__ == "__main__":
    main()
