#!/usr/bin/env python3
"""Rivals of models on the trials that the models were trained on, scored on other trials (docs/learning.md).

    python3 -m venv out/rivals && out/rivals/bin/pip install scikit-learn h5py
    out/rivals/bin/python scripts/learning_rivals.py --dataset data/hmmwv_32mm_unsolved/fresh.h5 MODEL...
    out/rivals/bin/python scripts/learning_rivals.py --dataset data/viper_32mm/dataset.h5 --folds 5

With --folds the rivals alone are cross-validated on the dataset, replicates in one fold. Otherwise other trials score than those that a model was trained on: those of another dataset, or those held out of its own.

Rivals of scikit-learn are boosted trees with the known monotone directions, logistic regression on squares and products,
and an ensemble of ten networks. `gonogo evaluate` scores model and exact Gaussian process, and how well rows of the machine
are told from trials. Models in folders trials_N_subset_K (`gonogo learning-curve`) are averaged over K.
"""
import argparse
import collections
import csv
import json
import pathlib
import re
import subprocess
import tempfile
import warnings

import h5py
import numpy
from sklearn.ensemble import HistGradientBoostingClassifier
from sklearn.linear_model import LogisticRegressionCV
from sklearn.model_selection import GroupKFold
from sklearn.neural_network import MLPClassifier
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import PolynomialFeatures, StandardScaler

# P(go) rises (1) or falls (-1) with these.
MONOTONE = {"slope_along": -1, "friction_angle": 1, "cohesion": 1, "tyre_friction": 1, "force_number": 1, "power_number": 1}


def trials_of_model(file):
    with h5py.File(file) as model:
        layout = json.loads(model["layout"][()])
        names = [variable["name"] for variable in layout["variables"]]
        outcomes = layout["outcomes"]
        passes = numpy.array([name.startswith(("go", "slow_go")) for name in outcomes])
        points = model["training/points"][()]
        return names, points, passes[model["training/outcomes"][()]].astype(int)


def trials_of_dataset(file, names):
    with h5py.File(file) as data:
        count = len(data["outcome/verdict"])
        points = numpy.column_stack([data["variables/" + n][()] if "variables/" + n in data else numpy.full(count, numpy.nan)
                                     for n in names])
        verdict = data["outcome/verdict"][()]
    known = verdict != 4
    return points[known], (verdict[known] <= 2).astype(int)


def unseen(points, happened, trained_on):
    """Without the trials that a model was trained on. Variables that a dataset lacks are 0 in its models."""
    seen = {tuple(row) for row in numpy.nan_to_num(trained_on)}
    kept = [k for k, row in enumerate(numpy.nan_to_num(points)) if tuple(row) not in seen]
    return points[kept], happened[kept]


class Networks:
    def __init__(self, x, y):
        self.members = [MLPClassifier((32, 32), alpha=0.3, max_iter=600, random_state=k).fit(x, y)
                        for k in range(10)]

    def predict_proba(self, x):
        return numpy.mean([member.predict_proba(x) for member in self.members], 0)


def rivals(names):
    directions = [MONOTONE.get(n, 0) for n in names]
    boosted = HistGradientBoostingClassifier(learning_rate=0.05, max_iter=300, max_leaf_nodes=15, min_samples_leaf=10,
                                             l2_regularization=1.0, monotonic_cst=directions, random_state=1)
    quadratic = make_pipeline(PolynomialFeatures(2, include_bias=False), StandardScaler(),
                              LogisticRegressionCV(Cs=numpy.logspace(-2, 2, 9), cv=5, scoring="neg_log_loss", max_iter=5000))
    return {"boosted trees": boosted.fit, "quadratic logistic": quadratic.fit,
            "networks": Networks}


def scores(p, happened):
    p = numpy.clip(p, 1e-12, 1 - 1e-12)
    return float(numpy.mean((p - happened) ** 2)), float(-numpy.mean(numpy.log(numpy.where(happened == 1, p, 1 - p))))


def model_scores(gonogo, model, names, points, happened):
    with tempfile.TemporaryDirectory() as folder:
        asked, answered = pathlib.Path(folder) / "points.csv", pathlib.Path(folder) / "answers.csv"
        known = [v for v in range(len(names)) if not numpy.isnan(points[:, v]).any()]
        with open(asked, "w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow([names[v] for v in known])
            writer.writerows([[repr(float(x)) for x in row] for row in points[:, known]])
        subprocess.run([gonogo, "infer", "--model", str(model), "--csv", str(asked), "--out", str(answered)], check=True,
                       stdout=subprocess.DEVNULL)
        with open(answered) as file:
            return scores(numpy.array([float(row["p_go"]) for row in csv.DictReader(file)]), happened)


def evaluated(gonogo, model, dataset):
    """Brier score and log loss of model and process, and two-sample AUC (bins, values) of machine and floor."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([gonogo, "evaluate", "--model", str(model), "--dataset", str(dataset), "--out", folder], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        found = json.loads((pathlib.Path(folder) / "evaluation.json").read_text())
    rows = {name: (found["scores"][key]["brier"], found["scores"][key]["log_loss_nat"])
            for name, key in (("model", "model"), ("Gaussian process", "gaussian_process"))}
    kinds = found["joint"]["kinds"]
    return rows | {name: (kinds[key]["auc_bins"], kinds[key]["auc_values"])
                   for name, key in (("AUC of rows", "machine"), ("AUC of trials", "trials"))}


def standardised(points, by):
    """Both arrays by the mean and spread of `by`, without the variables that do not vary in it."""
    used = numpy.nanstd(by, 0) > 0
    return [(x[:, used] - by[:, used].mean(0)) / by[:, used].std(0) for x in (by, points)], used


def cross_validated(dataset, folds):
    with h5py.File(dataset) as data:
        names = sorted(data["variables"])
        index, first = data["design/index"][()], data["design/replicate_of"][()].astype(int)
        known = data["outcome/verdict"][()] != 4
    points, label = trials_of_dataset(dataset, names)
    group = numpy.where(first < 0, index, first)[known]
    result = {}
    for name in rivals(names):
        p = numpy.zeros(len(label))
        for seen, held_out in GroupKFold(folds, shuffle=True, random_state=1).split(points, label, group):
            (x, z), used = standardised(points[held_out], points[seen])
            fit = rivals([n for n, u in zip(names, used) if u])[name]
            p[held_out] = fit(x, label[seen]).predict_proba(z)[:, 1]
        result[name] = scores(p, label)
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="*", type=pathlib.Path)
    parser.add_argument("--dataset", required=True, type=pathlib.Path, help="trials that score; those trained on are left out")
    parser.add_argument("--folds", type=int, default=0, help="cross-validate the rivals on the dataset instead")
    parser.add_argument("--gonogo", default="build/cpu-release/gonogo")
    options = parser.parse_args()
    if bool(options.models) == bool(options.folds):
        parser.error("name models, or give --folds")
    warnings.filterwarnings("ignore")  # of solvers that stop at their limit
    if options.folds:
        for name, (brier, loss) in cross_validated(options.dataset, options.folds).items():
            print(f"{name}: Brier {brier:.4f}, log loss {loss:.3f} nat")
        return
    found = collections.defaultdict(lambda: collections.defaultdict(list))
    for model in options.models:
        names, points, label = trials_of_model(model)
        fresh, happened = unseen(*trials_of_dataset(options.dataset, names), points)
        (x, z), used = standardised(fresh, points)
        size = len(label)
        folder = re.fullmatch(r"trials_(\d+)_subset_\d+", model.resolve().parent.name)
        row = found[int(folder[1]) if folder else size]
        for name, pair in evaluated(options.gonogo, model, options.dataset).items():
            row[name].append(pair)
        for name, fit in rivals([n for n, u in zip(names, used) if u]).items():
            row[name].append(scores(fit(x, label).predict_proba(z)[:, 1], happened))
    print("trials, models, scores (Brier, log loss [nat]) and AUC (bins, values): mean over the models")
    for size, row in sorted(found.items()):
        print(size, len(row["model"]), *(f"| {name} {numpy.mean(s, 0)[0]:.4f}, {numpy.mean(s, 0)[1]:.3f}" for name, s in row.items()))


if __name__ == "__main__":
    main()
