#!/usr/bin/env python3
# Copyright (c) 2026 The pcs authors
# SPDX-License-Identifier: BSL-1.0
"""Fits a Multilayer_perceptron (leaves/Multilayer_perceptron.h) to the rows of a file.

Reads a file of collect_wood_evidence, and prints the network in the format of its header. Needs
Debian's python3-sklearn. The last quarter of the scans is excluded from the fit and used to measure
the losses.
"""

import argparse

import numpy as np
from sklearn.metrics import log_loss
from sklearn.neural_network import MLPClassifier

COLUMNS = {"surroundings": 16, "paths": 12, "axes": 12}
BEFORE = 4  # columns before the features: scan, weight, label, likeness


def read(path):
    name = path.rsplit("/", 1)[-1].split(".")[0]
    if name not in COLUMNS:
        raise SystemExit(f"{path}: expected one of {', '.join(c + '.f32' for c in COLUMNS)}")
    rows = np.fromfile(path, dtype=np.float32).reshape(-1, BEFORE + COLUMNS[name]).astype(float)
    scans = np.unique(rows[:, 0])
    is_test = rows[:, 0] >= scans[len(scans) * 3 // 4]
    return rows[~is_test], rows[is_test]


def loss(rows, likeness):
    odds = np.clip(likeness, -9, 9)
    return log_loss(rows[:, 2], 1 / (1 + np.exp(-odds)), sample_weight=rows[:, 1])


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("file")
    parser.add_argument("--units", type=int, default=12)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    train, test = read(options.file)

    # rows are sampled by weight, since MLPClassifier has no weights
    random = np.random.default_rng(options.seed)
    share = np.minimum(train[:, 1], 10 * train[:, 1].mean())
    drawn = train[random.choice(len(train), len(train), p=share / share.sum())]
    features = drawn[:, BEFORE:]
    mean, deviation = features.mean(0), features.std(0) + 1e-9
    network = MLPClassifier((options.units,), alpha=1e-4, batch_size=512, learning_rate_init=3e-3,
                            max_iter=60, random_state=options.seed)
    network.fit((features - mean) / deviation, drawn[:, 2])

    weights = network.coefs_[0].T / deviation  # for features without standardization
    offsets = network.intercepts_[0] - weights @ mean
    output = network.coefs_[1][:, 0]
    last = network.intercepts_[1][0]
    likeness = np.maximum(0, test[:, BEFORE:] @ weights.T + offsets) @ output + last
    print(f"// loss {loss(test, likeness):.4f}, of the network in use {loss(test, test[:, 3]):.4f}, "
          f"of {len(test)} rows not used for fitting")

    def braces(numbers):
        return "{" + ", ".join(f"{x:.4g}" for x in numbers) + "}"
    print("{\n{\n" + ",\n".join(braces(row) for row in weights) + "},")
    print(braces(offsets) + ",\n" + braces(output) + f",\n{last:.4g}}};")


if __name__ == "__main__":
    main()
