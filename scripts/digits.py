#!/usr/bin/env python3
"""The program's machines against scikit-learn's on its handwritten digits; prints the table of docs/learning.md.

    scripts/digits.sh      installs scikit-learn into a throw-away environment and runs this

Data: sklearn.datasets.load_digits (UCI, Optical Recognition of Handwritten Digits, CC BY 4.0), pixels on from 8 of 16,
split by train_test_split(test_size=0.2, random_state=0). BernoulliRBM and the program's density have the same hidden units;
both are scored by the program's annealed importance sampling and by RAISE.
"""
import argparse
import os
import subprocess
import sys

import numpy
from sklearn.datasets import load_digits
from sklearn.linear_model import LogisticRegression
from sklearn.model_selection import train_test_split
from sklearn.neural_network import BernoulliRBM


def write_rows(path, pixels, labels):
    with open(path, "w") as file:
        for row, label in zip(pixels, labels):
            file.write(" ".join(str(int(x)) for x in row) + " %d\n" % label)


def write_machine(path, rbm):
    """visible hidden, then visible biases, hidden biases and W row by row."""
    weight = rbm.components_.T
    with open(path, "w") as file:
        file.write("%d %d\n" % weight.shape)
        for values in (rbm.intercept_visible_, rbm.intercept_hidden_, weight.ravel()):
            file.write(" ".join(repr(float(x)) for x in values) + "\n")


def shifted(rows, labels):
    """The rows and their shifts by one pixel in four directions, as scikit-learn's RBM example does, training rows only."""
    images = rows.reshape(-1, 8, 8)
    padded = numpy.pad(images, ((0, 0), (1, 1), (1, 1)))
    moves = [(1, 1), (0, 1), (2, 1), (1, 0), (1, 2)]
    return (numpy.concatenate([padded[:, i:i + 8, j:j + 8] for i, j in moves]).reshape(-1, 64),
            numpy.tile(labels, len(moves)))


def best_bernoulli_rbm(train, hidden, epochs):
    """Of several learning rates, the one with the best pseudo-likelihood of a tenth of the rows, trained on the others."""
    fit, check = train_test_split(train, test_size=0.1, random_state=1)
    scores = {}
    for rate in (0.005, 0.01, 0.02, 0.05, 0.1):
        rbm = BernoulliRBM(n_components=hidden, learning_rate=rate, n_iter=epochs, batch_size=10, random_state=0).fit(fit)
        scores[rate] = numpy.mean([rbm.score_samples(check).mean() for _ in range(20)])
    rate = max(scores, key=scores.get)
    print("BernoulliRBM: learning rate %g of %s" % (rate, sorted(scores)))
    return BernoulliRBM(n_components=hidden, learning_rate=rate, n_iter=epochs, batch_size=10, random_state=0).fit(train)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="learning_digits, built from tests/learning/digits_study.cpp")
    parser.add_argument("folder", help="where data and weights are put")
    parser.add_argument("--hidden", type=int, default=64)
    parser.add_argument("--epochs", type=int, default=200)
    parser.add_argument("setting", nargs="*", help="of the hybrid machine: hidden=400 ...")
    arguments = parser.parse_args()
    digits = load_digits()
    pixels = (digits.data >= 8).astype(int)
    train, test, train_label, test_label = train_test_split(pixels, digits.target, test_size=0.2, random_state=0)
    os.makedirs(arguments.folder, exist_ok=True)
    path = lambda name: os.path.join(arguments.folder, name)
    write_rows(path("train.txt"), train, train_label)
    write_rows(path("test.txt"), test, test_label)
    logistic = LogisticRegression(max_iter=5000).fit(train, train_label)
    print("label accuracy of logistic regression on pixels: %.4f" % logistic.score(test, test_label))
    rbm = best_bernoulli_rbm(train, arguments.hidden, arguments.epochs)
    features = LogisticRegression(max_iter=5000, C=100).fit(rbm.transform(train), train_label)
    print("label accuracy of BernoulliRBM and logistic regression: %.4f" % features.score(rbm.transform(test), test_label))
    write_machine(path("sklearn.txt"), rbm)
    sys.stdout.flush()
    run = lambda *rest: subprocess.run([arguments.program, *rest], check=True)
    run("density", path("train.txt"), path("test.txt"), path("sklearn.txt"))
    gray_train, gray_test, _, _ = train_test_split(digits.data, digits.target, test_size=0.2, random_state=0)
    for name, levels in (("one bit a pixel", [8]), ("thermometer of three bits a pixel", [4, 8, 12])):
        coded = lambda rows: numpy.concatenate([(rows >= level).astype(int) for level in levels], axis=1)
        moved, moved_label = shifted(gray_train, train_label)
        write_rows(path("train_labels.txt"), coded(moved), moved_label)
        write_rows(path("test_labels.txt"), coded(gray_test), test_label)
        run("labels", path("train_labels.txt"), path("test_labels.txt"), name, *arguments.setting)
    return 0


if __name__ == "__main__":
    sys.exit(main())
