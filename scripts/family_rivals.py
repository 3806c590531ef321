#!/usr/bin/env python3
"""Rivals of a family's model on trials of vehicles that it has not seen (docs/vehicles.md).

    python3 -m venv out/rivals && out/rivals/bin/pip install scikit-learn h5py
    out/rivals/bin/python scripts/family_rivals.py --model data/wheeled_family_32mm \\
        hmmwv=data/hmmwv_32mm_fresh/dataset.h5 viper=data/viper_32mm/dataset.h5

Semi-empirical relations give a margin (pipeline/map/rivals.h has the sources). As a forecast of P(go) each gets a
logistic curve of its margin, fitted to the trials of the family: the best that a user of the relation could do who has
these trials. `accuracy` is that of the relation as published: go where the margin is positive. Boosted trees and the
Gaussian process are scikit-learn's, on the same variables and trials.

Of two vehicles or more, every forecast is also scored with its log odds shifted by the number that suits the trials of the
other vehicles best, each counting alike. Trials of the vehicle itself have no part in it. For the family's model this is
what `gonogo train --vehicles` does with the others.
"""
import argparse
import csv
import pathlib
import subprocess
import tempfile
import warnings

import numpy
from sklearn.ensemble import HistGradientBoostingClassifier
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessClassifier
from sklearn.gaussian_process.kernels import RBF, ConstantKernel
from sklearn.linear_model import LogisticRegression
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

RELATIONS = ["cone_index", "drove_sand", "drove_clay", "bekker_wong"]
# P(go) rises (1) or falls (-1) with these.
MONOTONE = {"slope_along": -1, "friction_angle": 1, "cohesion": 1, "tyre_friction": 1, "force_number": 1, "power_number": 1}


def table(gonogo, model, dataset, folder):
    out = pathlib.Path(folder) / "forecasts.csv"
    subprocess.run([gonogo, "dataset", "forecasts", dataset, "--model", model, "--out", str(out)], check=True,
                   stdout=subprocess.DEVNULL)
    with open(out) as file:
        rows = list(csv.DictReader(file))
    return {name: numpy.array([float(row[name]) for row in rows]) for name in rows[0]}


def brier(p, y):
    return numpy.mean((p - y) ** 2)


def log_loss(p, y):
    p = numpy.clip(p, 1e-12, 1 - 1e-12)
    return -numpy.mean(numpy.log(numpy.where(y == 1, p, 1 - p)))


def calibration_error(p, y, bins=10):
    place = numpy.minimum((p * bins).astype(int), bins - 1)
    return sum(abs(p[place == k].mean() - y[place == k].mean()) * (place == k).mean() for k in set(place))


def scores(p, y):
    return f"{brier(p, y):7.4f} {log_loss(p, y):9.3f} {calibration_error(p, y):7.3f}"


def interval(p, y):
    """95 % of the Brier score, by 10,000 bootstrap samples of the trials."""
    picks = numpy.random.default_rng(1).integers(len(y), size=(10_000, len(y)))
    return "[%.4f, %.4f]" % tuple(numpy.percentile(((p - y) ** 2)[picks].mean(1), [2.5, 97.5]))


def shifted(p, shift):
    p = numpy.clip(p, 1e-6, 1 - 1e-6)
    return 1 / (1 + (1 - p) / p * numpy.exp(-shift))


def fitted_shift(pairs):
    """Of pairs of P(go) and outcome, one of each vehicle: where the forecast share is the passing one, on average."""
    low, high = -10.0, 10.0
    for _ in range(60):
        middle = (low + high) / 2
        if sum(numpy.mean(shifted(p, middle) - y) for p, y in pairs) < 0:
            low = middle
        else:
            high = middle
    return low


def fitted_rivals(train):
    """Every rival, fitted once: its name, P(go) of asked trials, and the accuracy there of its margin's sign or None."""
    y = train["passed"].astype(int)

    def relation(name):
        curve = LogisticRegression(C=100).fit(train[name][:, None], y)
        return (lambda asked: curve.predict_proba(asked[name][:, None])[:, 1],
                lambda asked: numpy.mean((asked[name] > 0) == asked["passed"]))

    names = list(train)
    variables = [n for n in names[:names.index("passed")] if numpy.std(train[n]) > 0]
    inputs = lambda t: numpy.column_stack([t[n] for n in variables])
    trees = HistGradientBoostingClassifier(learning_rate=0.05, max_iter=300, max_leaf_nodes=15, min_samples_leaf=10,
                                           l2_regularization=1.0, monotonic_cst=[MONOTONE.get(n, 0) for n in variables],
                                           random_state=1)
    process = make_pipeline(StandardScaler(), GaussianProcessClassifier(
        ConstantKernel(4.0, (0.1, 1e3)) * RBF([3.0] * len(variables), (0.3, 100)), random_state=1))

    def learner(forecaster):
        forecaster.fit(inputs(train), y)
        return lambda asked: forecaster.predict_proba(inputs(asked))[:, 1], lambda asked: None

    return [(name, *relation(name)) for name in RELATIONS] + [("boosted trees", *learner(trees)), ("Gaussian process", *learner(process))]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("datasets", nargs="+", help="name=dataset.h5 of one vehicle")
    parser.add_argument("--model", required=True, help="folder of the family's model, with its trials")
    parser.add_argument("--beside", nargs="*", default=[], help="more trials of the family that the model learned, for the rivals, too")
    parser.add_argument("--gonogo", default="build/cpu-release/gonogo")
    options = parser.parse_args()
    warnings.simplefilter("ignore", ConvergenceWarning)  # variables that tell nothing get the longest length allowed
    with tempfile.TemporaryDirectory() as folder:
        known = [table(options.gonogo, options.model, str(dataset), folder)
                 for dataset in (pathlib.Path(options.model) / "dataset.h5", *options.beside)]
        train = {name: numpy.concatenate([t[name] for t in known]) for name in known[0]}
        vehicles = dict(entry.split("=", 1) for entry in options.datasets)
        asked = {v: table(options.gonogo, options.model, dataset, folder) for v, dataset in vehicles.items()}
    happened = {v: t["passed"].astype(int) for v, t in asked.items()}
    rivals = fitted_rivals(train)
    said = {v: [("family", t["p_go"], numpy.mean((t["p_go"] > 0.5) == t["passed"])),
                *((name, p_go(t), accuracy(t)) for name, p_go, accuracy in rivals)] for v, t in asked.items()}
    for v, dataset in vehicles.items():
        print(f"{v}: {len(happened[v])} trials of {dataset}\n  {'':<16}   Brier  log loss     ECE  accuracy"
              + ("   shifted by the others: Brier, log loss, ECE" if len(vehicles) > 1 else ""))
        for k, (name, p, accuracy) in enumerate(said[v]):
            text = f"  {name.replace('_', ' '):<16} {scores(p, happened[v])} " + (f"{accuracy:9.3f}" if accuracy is not None else " " * 9)
            if len(vehicles) > 1:
                shift = fitted_shift([(said[other][k][1], happened[other]) for other in vehicles if other != v])
                q = shifted(p, shift)
                text += f"   {shift:+6.2f} {scores(q, happened[v])}" + (" " + interval(q, happened[v]) if name == "family" else "")
            print(text)


if __name__ == "__main__":
    main()
