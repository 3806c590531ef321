#!/usr/bin/env python3
"""How far labels depend on what no soil has: grain size, step, updates, extent of the bed, seed.

A pilot of the quarter wheel on 32 mm grains finds the 50 points nearest the boundary: those with a trial of the other
label closest by. Each factor is then changed alone, at the same points and seeds, the soil being met at every grain size
through the table of that size. The report has the share of labels that flip and how far slip moves.

  scripts/label_quality.py run out/labels --tables out/tables [--device cuda --places 48]
  scripts/label_quality.py report out/labels --docs docs      # writes convergence.md and convergence.csv there

Tables: calibration_16mm.json, _24mm, _32mm, _48mm, _64mm (gonogo soil calibrate --grain 0.016 ...). A grain size without
a table is left out, which the report says. An interrupted run continues. Needs Python alone.
"""
import argparse, copy, csv, json, math, pathlib, random, subprocess

HERE = pathlib.Path(__file__).resolve().parent.parent
BASE = "grain 32 mm"
RANGES = {"slope_along": (0, 30), "friction_angle": (20, 36), "relative_density": (0, 1)}
FIXED = {"slope_across": 0, "cohesion": 0.5, "payload": 0, "tyre_friction": 0.8, "bed_depth": 0.3, "commanded_speed": 1.5}


def variants():
    """Name, factor, changes of the study by path; the grain size goes by its table."""
    rows = [(f"grain {d} mm", "grain size", {"soil/calibration": f"calibration_{d}mm.json"}) for d in (16, 24, 32, 48, 64)]
    rows += [(f"step {h * 1e3:g} ms", "step", {"trial/numerics/step_s": h}) for h in (1e-3, 4e-3)]
    rows += [(f"{n} updates", "updates", {"trial/numerics/iterations": n}) for n in (50, 800)]
    rows += [("tolerance 1 mm/s", "updates", {"trial/numerics/tolerance_m_per_s": 1e-3, "trial/numerics/iterations": 800})]
    rows += [(f"bed {z} m deep", "bed depth", {"design/fixed/bed_depth": z}) for z in (0.2, 0.45)]
    rows += [(f"bed {w} m wide", "bed width", {"trial/bed/width_m": w}) for w in (0.6, 1.2)]
    rows += [(f"bed {l} m long", "bed length", {"trial/bed/tiles_along": n}) for l, n in ((2, 1), (6, 3))]
    rows += [("another seed", "seed", {"seed": 33})]
    return rows


def base_study(tables, out):
    study = json.loads((HERE / "configs/studies/quarter_wheel_32mm.json").read_text())
    for key in ("region", "map", "compute"):
        study.pop(key, None)
    study["vehicle"] = str(HERE / "configs/vehicles/hmmwv_quarter.json")
    study["soil"]["calibration"] = str(tables / "calibration_32mm.json")
    study["trial"]["bed"].pop("deepest_m", None)
    study["design"] = {"method": "csv", "file": str(out / "points.csv"), "fixed": dict(FIXED)}
    return study


def with_changes(study, changes, tables):
    study = copy.deepcopy(study)
    for path, value in changes.items():
        *parents, last = path.split("/")
        node = study
        for parent in parents:
            node = node[parent]
        node[last] = str(tables / value) if last == "calibration" else value
    return study


def campaign(options, study, folder):
    """Trials of a study as dictionaries, in the order of its points."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "study.json").write_text(json.dumps(study, indent=2) + "\n")
    command = [options.gonogo, "campaign", "run", str(folder / "study.json"), "--out", str(folder / "run"), "--device",
               options.device, "--places", str(options.places)]
    subprocess.run(command, check=True)
    table = folder / "trials.csv"
    subprocess.run([options.gonogo, "dataset", "export", str(folder / "run/dataset.h5"), "--format", "csv", "--out",
                    str(table)], check=True)
    with open(table) as file:
        return list(csv.DictReader(file))


def write_points(path, points):
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(RANGES)
        writer.writerows([[f"{p[name]:.6g}" for name in RANGES] for p in points])


def passes(trial):
    return trial["verdict"] in ("go", "slow_go")


def nearest_boundary(trials, count):
    """The points that have a trial of the other label closest by, in shares of the ranges."""
    known = [t for t in trials if t["verdict"] != "unknown"]
    place = lambda t: [(float(t[n]) - low) / (high - low) for n, (low, high) in RANGES.items() if n != "relative_density"]
    distance = []
    for t in known:
        others = [math.dist(place(t), place(o)) for o in known if passes(o) != passes(t)]
        if others:
            distance.append((min(others), len(distance), t))
    return [{n: float(t[n]) for n in RANGES} for _, _, t in sorted(distance)[:count]]


def run(options):
    out, tables = options.folder.resolve(), options.tables.resolve()
    out.mkdir(parents=True, exist_ok=True)
    draw = random.Random(50)
    study = base_study(tables, out)
    pilot = [{n: draw.uniform(*r) for n, r in RANGES.items()} for _ in range(options.pilot)]
    write_points(out / "pilot.csv", pilot)
    write_points(out / "points.csv",
                 nearest_boundary(campaign(options, with_changes(study, {"design/file": str(out / "pilot.csv")}, tables),
                                           out / "pilot"), options.points))
    for name, _, changes in variants():
        table = changes.get("soil/calibration")
        if table and not (tables / table).exists():
            print(f"{name}: no {table}; left out")
            continue
        campaign(options, with_changes(study, changes, tables), out / name.replace(" ", "_").replace("/", "_"))


def trials_of(folder, name):
    path = folder / name.replace(" ", "_").replace("/", "_") / "trials.csv"
    if not path.exists():
        return None
    with open(path) as file:
        return list(csv.DictReader(file))


def number(text):
    return float(text) if text else math.nan


def compare(base, other):
    """Share of labels that flip, its standard error, mean and root-mean-square change of slip, unknown trials."""
    both = [(a, b) for a, b in zip(base, other) if "unknown" not in (a["verdict"], b["verdict"])]
    flips = sum(passes(a) != passes(b) for a, b in both)
    slips = [min(2.0, number(b["slip"])) - min(2.0, number(a["slip"])) for a, b in both
             if not math.isnan(number(a["slip"]) + number(b["slip"]))]
    n, share = len(both), flips / max(1, len(both))
    return {"trials": n, "unknown": len(base) - n, "flip_share": share, "error": math.sqrt(share * (1 - share) / max(1, n)),
            "mean_slip": sum(slips) / max(1, len(slips)), "rms_slip": math.sqrt(sum(s * s for s in slips) / max(1, len(slips)))}


def report(options):
    base = trials_of(options.folder, BASE)
    if base is None:
        raise SystemExit(f"{options.folder}: no trials of \"{BASE}\"; run first")
    lines = ["# Label quality", "",
             f"`scripts/label_quality.py`: the {len(base)} points of the quarter wheel nearest the boundary between passing",
             "(go, slow-go) and not, each factor changed alone at the same points, beside 32 mm grains, 2 ms, up to 200 updates",
             "to 5 mm/s, a bed 4 m long, 0.8 m wide, 0.3 m deep. Slip above 2 counts as 2. These points are the hardest there",
             "are: over a whole map far fewer labels flip.", "",
             "| factor | changed to | trials | unknown | labels that flip | slip, mean change | slip, rms change |",
             "|---|---|---|---|---|---|---|"]
    rows, missing = [], []
    for name, factor, _ in variants():
        if name == BASE:
            continue
        trials = trials_of(options.folder, name)
        if trials is None:
            missing.append(name)
            continue
        c = compare(base, trials)
        rows.append({"factor": factor, "variant": name, **c})
        lines.append(f"| {factor} | {name} | {c['trials']} | {c['unknown']} | {c['flip_share']:.2f} +- {c['error']:.2f} | "
                     f"{c['mean_slip']:+.3f} | {c['rms_slip']:.3f} |")
    if missing:
        lines += ["", "Not run: " + ", ".join(missing) + "."]
    (options.docs / "convergence.md").write_text("\n".join(lines) + "\n")
    with open(options.docs / "convergence.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, ["factor", "variant", "trials", "unknown", "flip_share", "error", "mean_slip", "rms_slip"])
        writer.writeheader()
        writer.writerows(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    runs = commands.add_parser("run")
    runs.add_argument("folder", type=pathlib.Path)
    runs.add_argument("--tables", type=pathlib.Path, default=HERE / "configs/soils")
    runs.add_argument("--gonogo", default=str(HERE / "build/cuda-release/gonogo"))
    runs.add_argument("--device", default="cuda")
    runs.add_argument("--places", type=int, default=48)
    runs.add_argument("--pilot", type=int, default=200)
    runs.add_argument("--points", type=int, default=50)
    reports = commands.add_parser("report")
    reports.add_argument("folder", type=pathlib.Path)
    reports.add_argument("--docs", type=pathlib.Path, default=HERE / "docs")
    options = parser.parse_args()
    run(options) if options.command == "run" else report(options)


main()
