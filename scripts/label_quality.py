#!/usr/bin/env python3
"""How far labels depend on what no soil has: grain size, step, updates, extent of the bed, seed.

The 50 points of the frozen quarter-wheel dataset nearest the boundary between passing (go, slow-go) and not are driven
again; each factor is changed alone, at the same points and bed seeds, the soil being met at every grain size through a
table of that size. The report has the share of labels that flip and how far slip moves.

  scripts/label_quality.py points                                 # chooses them: data/quarter_wheel_32mm/boundary_points.csv
  scripts/label_quality.py run out/labels --seconds 300           # on a GPU; builds the program where there is none
  scripts/label_quality.py report out/labels                      # docs/convergence.md and .csv
  scripts/label_quality.py report data/quarter_wheel_32mm/label_trials   # the same from the trials kept there
  scripts/label_quality.py cost                                   # what is expected of every variant

`run` starts no variant that is not expected to end in the time left (one that fits no run begins one) and says which are
left; the same command goes on.
Of what it writes, FOLDER/*/trials.csv is all that `report` and a later `run` need; those of docs/convergence.md are kept in
data/quarter_wheel_32mm/label_trials, a copy of which is a FOLDER to go on with. A table calibration_24mm.json, ... in
--tables is taken where there is one; otherwise that of 32 mm with the other diameter (nothing in a triaxial test without
gravity depends on the grain's size: docs/soils.md), which the report says. Needs Python alone.
"""
import argparse, csv, json, math, pathlib, signal, statistics, subprocess, time

HERE = pathlib.Path(__file__).resolve().parent.parent
DATA = HERE / "data/quarter_wheel_32mm"
BASE = "grains of 32 mm"
SECONDS_PER_TRIAL = 1.4  # of an H200, amortised in a batch, on a bed of the study (docs/convergence.md)
SECONDS_PER_PACKING = 2.8  # 25 s for nine, settled on the GPU in one batch (docs/campaigns.md)
SOLVER_SHARE = 0.85  # of a step (docs/campaigns.md: 17.6 of 20.6 ms)
PACKINGS = 3  # levels of density; one packing of each, which every bed seed shifts
WIDTH, DEPTH = 0.8, 0.36  # of the study's bed [m]
LENGTH = 2.72  # [m] 0.12 more than the study's, so that grains of 64 mm have room for a slab of the moving patch


def variants():
    """Name, factor, changes of the study by path, trials' cost and grains over those of the base, packings of its own."""
    own = lambda name, factor, changes, grains: (name, factor, changes, grains, grains, PACKINGS)
    grain = lambda d: own(f"grains of {d} mm", "grain size", {"soil/calibration": d}, (32 / d) ** 3)
    iterations = (1 - SOLVER_SHARE) + SOLVER_SHARE * (10 * 20) / (14 * 2)
    return [
        (BASE, "grain size", {}, 1, 1, PACKINGS),
        ("another seed", "seed", {"seed": 33}, 1, 1, 0),
        grain(64), grain(48),
        ("step 0.5 ms", "step", {"trial/numerics/step_s": 5e-4}, 2, 1, 0),
        grain(24),
        own("bed 1.5 times as deep", "bed depth", {"depth": 1.5, "trial/bed/deepest_m": 1.5 * DEPTH}, 1.5),
        own("bed 1.2 m wide", "bed width", {"trial/bed/width_m": 1.5 * WIDTH}, 1.5),
        own("bed 4.1 m long", "bed length", {"trial/bed/length_m": 1.5 * LENGTH}, 1.5),
        ("10 x 20 iterations", "iterations", {"trial/numerics/substeps": 10, "trial/numerics/iterations": 20}, iterations, 1, 0),
        grain(16),
    ]


def seconds_per_trial(variant):
    return SECONDS_PER_TRIAL * variant[3]


def expected_seconds(variant, points):
    *_, grains, packings = variant
    return points * seconds_per_trial(variant) + packings * SECONDS_PER_PACKING * grains


def places_of(variant, options):
    """Trials side by side: few enough for two waves in the time given, as a trial that is stopped begins anew."""
    return max(1, min(options.places, int(0.45 * options.seconds / seconds_per_trial(variant))))


# The points: least |log odds| of passing by a logistic regression on all products of two variables.

def ranges():
    return json.loads((HERE / "configs/studies/quarter_wheel_32mm.json").read_text())["design"]["ranges"]


def passes(trial):
    return trial["verdict"] in ("go", "slow_go")


def features(trial, ranges):
    unit = [2 * (float(trial[n]) - low) / (high - low) - 1 for n, (low, high) in ranges.items()]
    return [1.0] + unit + [a * b for i, a in enumerate(unit) for b in unit[i:]]


def solve(matrix, right):
    """Cholesky; the matrix is symmetric and positive definite."""
    n, low = len(right), [[0.0] * len(right) for _ in right]
    for i in range(n):
        for j in range(i + 1):
            rest = matrix[i][j] - sum(a * b for a, b in zip(low[i][:j], low[j][:j]))
            low[i][j] = math.sqrt(rest) if i == j else rest / low[j][j]
    y = []
    for i in range(n):
        y.append((right[i] - sum(a * b for a, b in zip(low[i], y))) / low[i][i])
    x = [0.0] * n
    for i in reversed(range(n)):
        x[i] = (y[i] - sum(low[k][i] * x[k] for k in range(i + 1, n))) / low[i][i]
    return x


def log_odds(trials, ranges, rounds=12, ridge=1.0):
    """Of passing, for every trial: Newton's method on the penalised likelihood."""
    rows, labels = [features(t, ranges) for t in trials], [float(passes(t)) for t in trials]
    n = len(rows[0])
    weight = [0.0] * n
    for _ in range(rounds):
        gradient, hessian = [-ridge * w for w in weight], [[0.0] * n for _ in range(n)]
        for row, label in zip(rows, labels):
            p = 1 / (1 + math.exp(-max(-30, min(30, sum(a * b for a, b in zip(row, weight))))))
            for i, a in enumerate(row):
                gradient[i] += (label - p) * a
                scaled, line = p * (1 - p) * a, hessian[i]
                for j in range(i + 1):
                    line[j] += scaled * row[j]
        for i in range(n):
            hessian[i][i] += ridge
            for j in range(i):
                hessian[j][i] = hessian[i][j]
        weight = [w + s for w, s in zip(weight, solve(hessian, gradient))]
    return [sum(a * b for a, b in zip(row, weight)) for row in rows]


def choose_points(options):
    table = options.out.with_suffix(".all.csv")
    subprocess.run([options.gonogo, "dataset", "export", str(DATA / "dataset.h5"), "--format", "csv", "--out", str(table)],
                   check=True)
    with open(table) as file:
        trials = [t for t in csv.DictReader(file) if t["verdict"] != "unknown" and t["replicate_of"] == "-1"]
    table.unlink()
    odds = log_odds(trials, ranges())
    right = sum(passes(t) == (o > 0) for t, o in zip(trials, odds))
    nearest = sorted(range(len(trials)), key=lambda k: abs(odds[k]))[:options.points]
    with open(options.out, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(ranges())
        writer.writerows([trials[k][n] for n in ranges()] for k in nearest)
    print(f"{right} of {len(trials)} trials on the side that the regression says; {len(nearest)} points, the farthest at odds of "
          f"{math.exp(abs(odds[nearest[-1]])):.2f} to 1; {sum(passes(trials[k]) for k in nearest)} of them pass")


# Trials.

def folder_of(out, name):
    return out / name.replace(" ", "_")


def own_table(diameter, tables):
    return tables / f"calibration_{diameter}mm.json"


def table_for(diameter, tables, out):
    """The table of a grain size, or that of 32 mm with another diameter."""
    own = own_table(diameter, tables)
    if own.exists():
        return own
    table = json.loads((tables / "calibration_32mm.json").read_text())
    table["grain_diameter_m"] = diameter / 1e3
    copied = out / f"scaled_{diameter}mm.json"
    copied.write_text(json.dumps(table, indent=2) + "\n")
    return copied


def scaled_points(points, factor, path):
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, points[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows({**p, "bed_depth": f"{float(p['bed_depth']) * factor:.10g}"} for p in points)


def study_of(variant, points, tables, out):
    name, _, changes, *_ = variant
    study = json.loads((HERE / "configs/studies/quarter_wheel_32mm.json").read_text())
    for key in ("region", "map", "compute", "learning"):
        study.pop(key, None)
    folder = folder_of(out, name)
    folder.mkdir(parents=True, exist_ok=True)
    scaled_points(points, changes.get("depth", 1), folder / "points.csv")
    study["vehicle"] = str(HERE / "configs/vehicles/hmmwv_quarter.json")
    study["soil"]["calibration"] = str(table_for(changes.get("soil/calibration", 32), tables, out))
    study["trial"]["bed"].update(packing_seeds=1, length_m=LENGTH)
    study["design"] = {"method": "csv", "file": str(folder / "points.csv")}
    for path, value in changes.items():
        if path in ("soil/calibration", "depth"):
            continue
        *parents, last = path.split("/")
        node = study
        for parent in parents:
            node = node[parent]
        node[last] = value
    return study


def trials_of(out, name):
    path = folder_of(out, name) / "trials.csv"
    if not path.exists():
        return None
    with open(path) as file:
        return list(csv.DictReader(file))


def run_variant(options, study, folder, places, seconds):
    """Whether it ended; stopped by the clock it goes on in the next run."""
    file = folder / "study.json"
    file.write_text(json.dumps(study, indent=2) + "\n")
    process = subprocess.Popen([options.gonogo, "campaign", "run", str(file), "--out", str(folder / "run"), "--device",
                                options.device, "--places", str(places), "--workers", str(options.workers)])
    try:
        if process.wait(timeout=seconds) != 0:
            raise SystemExit(f"{folder}: the campaign ended with an error; what it says stands above")
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGINT)
        process.wait()
        return False
    subprocess.run([options.gonogo, "dataset", "export", str(folder / "run/dataset.h5"), "--format", "csv", "--out",
                    str(folder / "trials.csv")], check=True)
    return True


def build_where_missing(options):
    if pathlib.Path(options.gonogo).exists():
        return
    if options.gonogo != str(HERE / "build/cuda-release/gonogo"):
        raise SystemExit(f"{options.gonogo}: no such program; build it or leave --gonogo out")
    subprocess.run(["bash", "-c", f'source "{HERE}/scripts/common.sh" && build_gpu_program'], check=True)


def run(options):
    build_where_missing(options)
    out, tables = options.folder.resolve(), options.tables.resolve()
    out.mkdir(parents=True, exist_ok=True)
    with open(options.file) as file:
        points = list(csv.DictReader(file))[:options.points]
    begin, pace, left = time.monotonic(), 1.0, []
    for variant in variants():
        name = variant[0]
        done = trials_of(out, name)
        if done and len(done) >= len(points):
            continue
        remaining = options.seconds - (time.monotonic() - begin)
        expected = pace * expected_seconds(variant, len(points))
        # What fits no run of this length is begun by one that has all its time, and gone on with by the next.
        if expected > remaining and remaining < 0.9 * options.seconds:
            left.append(name)
            continue
        start = time.monotonic()
        ended = run_variant(options, study_of(variant, points, tables, out), folder_of(out, name),
                            places_of(variant, options), remaining)
        took = time.monotonic() - start
        print(f"{name}: {took:.0f} s, expected {expected:.0f} s{'' if ended else '; not over'}", flush=True)
        if not ended:
            left.append(name)
            pace = max(pace, took / expected * pace)
    print("all variants are done" if not left else "left for the same command: " + ", ".join(left))


def cost(options):
    total = 0
    print("seconds of an H200   cost of a trial   variant")
    for v in variants():
        s = expected_seconds(v, options.points)
        total += s
        print(f"{s:18.0f}   {v[3]:15.2f}   {v[0]}")
    print(f"{total:18.0f}   in all, {options.points} points, {SECONDS_PER_TRIAL} s a trial of the base")


# The report.

def number(text):
    return float(text) if text else math.nan


def error_of_mean(values):
    n = len(values)
    mean = sum(values) / max(1, n)
    return math.sqrt(sum((v - mean) ** 2 for v in values) / max(1, n * (n - 1)))


def slip_of(trial):
    return min(2.0, number(trial["slip"]))


def same_point(a, b, names):
    return all(abs(float(a[n]) - float(b[n])) < 1e-9 for n in names if n != "bed_depth")  # a variant scales it


def compare(base, other, names):
    """Share of labels that flip and its standard error, by sign; change of slip and sinkage; unknown trials. Of the points
    that both have: with another seed another point is the one that is replicated."""
    found = {t["index"]: t for t in other}
    pairs = [(a, found[a["index"]]) for a in base if a["index"] in found and same_point(a, found[a["index"]], names)]
    both = [(a, b) for a, b in pairs if "unknown" not in (a["verdict"], b["verdict"])]
    up = sum(passes(b) and not passes(a) for a, b in both)
    down = sum(passes(a) and not passes(b) for a, b in both)
    slips = [slip_of(b) - slip_of(a) for a, b in both
             if not math.isnan(number(a["slip"]) + number(b["slip"]))]
    sinkages = [number(b["sinkage"]) - number(a["sinkage"]) for a, b in both
                if not math.isnan(number(a["sinkage"]) + number(b["sinkage"]))]
    n = len(both)
    # Laplace's rule of succession: no flip in 50 is not an error of nought.
    share, fair = (up + down) / max(1, n), (up + down + 1) / (n + 2)
    return {"trials": n, "unknown": len(pairs) - n, "flip_share": share, "error": math.sqrt(fair * (1 - fair) / max(1, n)),
            "pass_now": up, "fail_now": down, "mean_slip": sum(slips) / max(1, len(slips)),
            "rms_slip": math.sqrt(sum(s * s for s in slips) / max(1, len(slips))),
            "slip_error": error_of_mean(slips), "mean_sinkage": sum(sinkages) / max(1, len(sinkages)),
            "sinkage_error": error_of_mean(sinkages)}


def changes_text(c):
    """The columns of labels, slip and sinkage of a compare()."""
    return (f"{c['flip_share']:.2f} +- {c['error']:.2f} | {c['pass_now']}, {c['fail_now']} | "
            f"{c['mean_slip']:+.3f} +- {c['slip_error']:.3f} | {1e3 * c['mean_sinkage']:+.0f} +- {1e3 * c['sinkage_error']:.0f}")


def write_report(page, lines, columns, rows):
    """The page, whose conclusion after the table is written by hand and stays, and the table beside it as CSV."""
    conclusion = page.read_text().partition("\n## ")[1:] if page.exists() else ()
    page.write_text("\n".join(lines) + "\n" + "".join(conclusion))
    with open(page.with_suffix(".csv"), "w", newline="") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    print("\n".join(lines))


HEADER = """# Label quality

For anyone who trains on the quarter-wheel trials or reads one of their labels: what moves a label, and by how much.

    scripts/label_quality.py run out/labels --seconds 300                   # on a GPU; the same command continues
    scripts/label_quality.py report data/quarter_wheel_32mm/label_trials    # this table, from the trials kept there

{count} points are driven again with one factor changed, at the same bed seeds. They are the hardest labels of
`data/quarter_wheel_32mm`: those nearest the boundary between passing (go, slow-go) and not. A logistic regression on all
products of two variables says where that is. {replicates} points are driven on a second bed as well.

The base is the study's own: grains of 32 mm and steps of 1 ms in 14 substeps of 2 iterations. Its moving patch is 2.72 m
by 0.8 m, 0.12 m longer than the study's. Of its {trials} trials {passing} pass and {unknown} are unknown. The mean slip is {slip:.2f}, the
mean sinkage {sinkage:.0f} mm.

Slip and sinkage are mean changes with their standard errors; slip above 2 counts as 2. Cost is what a trial is expected to
take, over the base's. A change of grains or bed also puts other grains under the wheel. The row "another seed" shows what
that alone does. All columns are in [convergence.csv](convergence.csv).

| changed to | trials | labels that flip | now pass, now fail | slip | sinkage [mm] | cost |
|---|---|---|---|---|---|---|"""


def report(options):
    base = trials_of(options.folder, BASE)
    if base is None:
        raise SystemExit(f"{options.folder}: no trials of \"{BASE}\"; run first")
    replicates = sum(t["replicate_of"] != "-1" for t in base)
    known = [t for t in base if t["verdict"] != "unknown"]
    lines = HEADER.format(count=len(base) - replicates, replicates=replicates, trials=len(base), passing=sum(map(passes, base)),
                          unknown=len(base) - len(known), slip=statistics.mean(map(slip_of, known)),
                          sinkage=1e3 * statistics.mean(number(t["sinkage"]) for t in known)).split("\n")
    rows, missing = [], []
    for name, factor, changes, cost_of_trial, *_ in variants():
        if name == BASE:
            continue
        trials = trials_of(options.folder, name)
        if trials is None:
            missing.append(name)
            continue
        c = compare(base, trials, ranges())
        rows.append({"factor": factor, "variant": name, **c})
        unknown = f", {c['unknown']} unknown" if c["unknown"] else ""
        lines.append(f"| {name} | {c['trials']}{unknown} | {changes_text(c)} | {cost_of_trial:.2g} |")
    scaled = [f"{d} mm" for d in (16, 24, 48, 64)
              if not own_table(d, options.tables).exists() and trials_of(options.folder, f"grains of {d} mm")]
    if scaled:
        lines += ["", "Grains of " + ", ".join(scaled) + " are met through the table of 32 mm with the diameter changed."]
    if missing:
        lines += ["", "Not run: " + ", ".join(missing) + "."]
    write_report(options.docs / "convergence.md", lines, ["factor", "variant", *compare(base, base, ranges())], rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    chosen = commands.add_parser("points")
    chosen.add_argument("--out", type=pathlib.Path, default=DATA / "boundary_points.csv")
    runs = commands.add_parser("run")
    runs.add_argument("folder", type=pathlib.Path)
    runs.add_argument("--file", type=pathlib.Path, default=DATA / "boundary_points.csv")
    runs.add_argument("--device", default="cuda")
    runs.add_argument("--places", type=int, default=64)
    runs.add_argument("--workers", type=int, default=0, help="0: one per GPU")
    runs.add_argument("--seconds", type=float, default=300)
    for command in (chosen, runs):
        command.add_argument("--gonogo", default=str(HERE / "build/cuda-release/gonogo"))
    reports = commands.add_parser("report")
    reports.add_argument("folder", type=pathlib.Path)
    reports.add_argument("--docs", type=pathlib.Path, default=HERE / "docs")
    for command in (runs, reports):
        command.add_argument("--tables", type=pathlib.Path, default=DATA)
    costs = commands.add_parser("cost")
    for command in (chosen, runs, costs):
        command.add_argument("--points", type=int, default=50)
    options = parser.parse_args()
    {"points": choose_points, "run": run, "cost": cost, "report": report}[options.command](options)


if __name__ == "__main__":
    main()
