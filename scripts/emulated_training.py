#!/usr/bin/env python3
"""Training with an emulated annealer in the loop beside training on exact samples (docs/annealer.md).

    python3 -m venv out/rivals && out/rivals/bin/pip install scikit-learn h5py
    out/rivals/bin/python scripts/emulated_training.py --out out/emulated --seeds 5

Every seed holds out other trials of data/quarter_wheel_32mm, trains on the rest and scores three machines that differ in
the sampler of the negative phase alone: exact sums, the emulator on a Pegasus P16 and on a Zephyr Z15, with 2 % dead
qubits and published noise. The rows of a machine are drawn on the host, so the scores judge training alone. Finished
machines are kept in --out.
"""
import argparse
import collections
import csv
import json
import pathlib
import subprocess

import numpy
from sklearn.ensemble import HistGradientBoostingClassifier
from sklearn.metrics import roc_auc_score
from sklearn.model_selection import StratifiedKFold, cross_val_predict

from learning_rivals import model_scores, trials_of_dataset, trials_of_model, unseen

DATASET = "data/quarter_wheel_32mm/dataset.h5"
BASE = "configs/studies/quarter_wheel_c12.json"
LEARNING = {"hidden": 8, "weight_decay": 0.3, "epochs": 80, "chains": 64, "learning_rate": 0.02, "final_learning_rate": 0.05}
SAMPLERS = {"exact": {"sampler": "exact"}} | {
    name: {"sampler": "emulator", "emulator": {"graph": graph, "dead_share": 0.02}}
    for name, graph in (("Pegasus P16", "pegasus:16"), ("Zephyr Z15", "zephyr:15"))}
ROWS = 3000  # of the machine, told from as many held-out trials


def reads_of_training(trials, readings):
    """Rows that the machine gave: of every update, and of every reading of the temperature."""
    updates = LEARNING["epochs"] * max(1, trials // 32)
    return updates * LEARNING["chains"] + readings * 250


def trained(options, name, seed):
    folder = options.out / f"{name.split()[0].lower()}_{seed}"
    model = folder / "model.h5"
    if not model.exists():
        folder.mkdir(parents=True, exist_ok=True)
        study = json.loads(pathlib.Path(BASE).read_text())
        study["learning"] |= LEARNING | SAMPLERS[name]
        (folder / "study.json").write_text(json.dumps(study))
        subprocess.run([options.gonogo, "train", "--dataset", DATASET, "--study", folder / "study.json", "--hold-out",
                        str(options.hold_out), "--seed", str(seed), "--out", model], check=True, stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL)
    return model


def rows_of(options, model, names, seed):
    file = model.parent / "rows.csv"
    subprocess.run([options.gonogo, "sample", "--model", model, "--rows", str(ROWS), "--seed", str(seed), "--out", file],
                   check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    with open(file) as text:
        rows = list(csv.DictReader(text))
    return (numpy.array([[float(row[n]) for n in names] for row in rows]),
            numpy.array([row["outcome"].startswith(("go", "slow_go")) for row in rows]).astype(int))


def held_out(model):
    names, points, _ = trials_of_model(model)
    return names, *unseen(*trials_of_dataset(DATASET, names), points)


def auc(x, passes, rows, row_passes, seed):
    order = numpy.random.default_rng(seed).permutation(len(x))[:ROWS]
    both = numpy.column_stack([numpy.vstack([x[order], rows]), numpy.append(passes[order], row_passes)])
    label = numpy.append(numpy.zeros(len(order)), numpy.ones(len(rows)))
    trees = HistGradientBoostingClassifier(max_iter=100, learning_rate=0.05, max_leaf_nodes=15, random_state=seed)
    folds = StratifiedKFold(5, shuffle=True, random_state=seed)
    return roc_auc_score(label, cross_val_predict(trees, both, label, cv=folds, method="predict_proba")[:, 1])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", required=True, type=pathlib.Path)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--hold-out", type=int, default=3700)
    parser.add_argument("--gonogo", default="build/cpu-release/gonogo")
    options = parser.parse_args()
    found = collections.defaultdict(list)
    for seed in range(1, options.seeds + 1):
        for name in SAMPLERS:
            model = trained(options, name, seed)
            names, x, passes = held_out(model)
            used = [v for v in range(len(names)) if numpy.std(x[:, v]) > 0]
            rows, row_passes = rows_of(options, model, [names[v] for v in used], seed)
            brier, _ = model_scores(options.gonogo, model, names, x, passes)
            found[name].append((auc(x[:, used], passes, rows, row_passes, seed), brier, row_passes.mean() - passes.mean()))
            print(f"seed {seed}, {name}: AUC {found[name][-1][0]:.3f}, Brier score {brier:.4f}, P(go or slow-go) of rows less "
                  f"that of trials {found[name][-1][2]:+.3f}", flush=True)
    exact = numpy.array(found["exact"])
    for name, scores in found.items():
        scores = numpy.array(scores)
        apart, error = (scores - exact).mean(0), (scores - exact).std(0, ddof=1) / len(scores) ** 0.5
        print(f"{name}: AUC {scores[:, 0].mean():.3f}, {apart[0]:+.3f} +- {error[0]:.3f}; Brier score "
              f"{scores[:, 1].mean():.4f}, {apart[1]:+.4f} +- {error[1]:.4f}; P(go or slow-go) {scores[:, 2].mean():+.3f}")
    trials = len(trials_of_model(trained(options, "exact", 1))[1])
    print(f"{trials} trials: a machine takes {reads_of_training(trials, LEARNING['epochs']):,} reads")


if __name__ == "__main__":
    main()
