#!/usr/bin/env python3
"""Which fidelity is right: the same points driven by the whole HMMWV and by a quarter of it, on compliant and on rigid
tyres, over grains of 32 and of 90 mm.

30 points of the HMMWV's dataset, those nearest the boundary between passing (go, slow-go) and not, are driven again. The
reference is the dataset's own trials: the whole vehicle on compliant tyres over grains of 32 mm.

  scripts/fidelity_study.py points                               # chooses them: data/hmmwv_32mm_unsolved/fidelity_points.csv
  scripts/fidelity_study.py run out/fidelity [--device cuda] [--only NAME...]   # resumes where it was stopped
  scripts/fidelity_study.py report out/fidelity                  # docs/fidelity.md and .csv

Of what `run` writes, FOLDER/*/trials.csv is all that `report` needs. Needs Python alone.
"""
import argparse, csv, json, pathlib, statistics, subprocess

from label_quality import changes_text, compare, log_odds, number, passes, slip_of, table_for, write_report

HERE = pathlib.Path(__file__).resolve().parent.parent
DATA = HERE / "data/hmmwv_32mm_unsolved"
STUDY = HERE / "configs/studies/hmmwv_32mm.json"
REFERENCE = "whole vehicle, compliant tyres, 32 mm"
QUARTER_BED = {"length_m": 2.72, "width_m": 0.8, "moving_patch": True, "packing_seeds": 1, "settle_s": 0.25, "deepest_m": 0.27}
COARSE_STEP = {"step_s": 2e-3}  # of the demo: a soil's only time grows with the grain


def variants():
    """Name, vehicle, tyres give way, grains [mm], changes of the trial's sections."""
    quarter = lambda compliant, grains, **changes: (
        f"quarter, {'compliant' if compliant else 'rigid'} tyre, {grains} mm", "hmmwv_quarter", compliant, grains,
        {"bed": QUARTER_BED, **changes})
    return [
        quarter(True, 32), quarter(False, 32),
        quarter(True, 90, numerics=COARSE_STEP, bed={**QUARTER_BED, "length_m": 3.6}),
        quarter(False, 90, numerics=COARSE_STEP, bed={**QUARTER_BED, "length_m": 3.6}),
        ("whole vehicle, compliant tyres, 90 mm", "hmmwv", True, 90, {"numerics": COARSE_STEP}),
        ("whole vehicle, rigid tyres, 32 mm", "hmmwv", False, 32, {}),
        quarter(True, 16, numerics={"step_s": 5e-4}),
    ]


def ranges():
    return json.loads(STUDY.read_text())["design"]["ranges"]


def export(gonogo, dataset, table):
    subprocess.run([gonogo, "dataset", "export", str(dataset), "--format", "csv", "--out", str(table)], check=True)
    with open(table) as file:
        return list(csv.DictReader(file))


def choose_points(options):
    table = options.out.with_suffix(".all.csv")
    trials = [t for t in export(options.gonogo, DATA / "dataset.h5", table)
              if t["verdict"] != "unknown" and t["replicate_of"] == "-1"]
    table.unlink()
    odds = log_odds(trials, ranges())
    nearest = sorted(sorted(range(len(trials)), key=lambda k: abs(odds[k]))[:options.points])
    columns = ["trial", *ranges(), "verdict", "slip", "sinkage"]
    with open(options.out, "w", newline="") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows({**{c: trials[k][c] for c in columns[1:]}, "trial": trials[k]["index"]} for k in nearest)
    print(f"{len(nearest)} of {len(trials)} points; {sum(passes(trials[k]) for k in nearest)} of them pass")


def read_points():
    with open(DATA / "fidelity_points.csv") as file:
        return list(csv.DictReader(file))


# Trials.

def folder_of(out, name):
    return out / name.replace(", ", "_").replace(" ", "_")


def study_of(variant, points, folder):
    name, vehicle, compliant, grains, changes = variant
    study = json.loads(STUDY.read_text())
    for key in ("region", "map", "compute", "learning", "about"):
        study.pop(key, None)
    with open(folder / "points.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, list(ranges()), extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        writer.writerows(points)
    study["study"] = folder.name.replace("_", "-")
    study["vehicle"] = str(HERE / f"configs/vehicles/{vehicle}.json")
    study["soil"]["calibration"] = str(table_for(grains, HERE / "configs/soils", folder))
    study["trial"]["compliant_tyres"] = compliant
    for section, values in changes.items():
        study["trial"][section] = values if section == "bed" else {**study["trial"][section], **values}
    study["design"] = {"method": "csv", "file": str(folder / "points.csv")}
    return study


def run(options):
    points = read_points()
    for variant in variants():
        folder = folder_of(options.folder.resolve(), variant[0])
        if (options.only and folder.name not in options.only) or (folder / "trials.csv").exists():
            continue
        folder.mkdir(parents=True, exist_ok=True)
        file = folder / "study.json"
        file.write_text(json.dumps(study_of(variant, points, folder), indent=2) + "\n")
        print(f"{variant[0]}: {folder}", flush=True)
        command = [options.gonogo, "campaign", "run", str(file), "--out", str(folder / "run"), "--device", options.device]
        subprocess.run(command + (["--threads", str(options.threads)] if options.threads else []), check=True)
        export(options.gonogo, folder / "run/dataset.h5", folder / "trials.csv")


# The report.

HEADER = """# Fidelity

For anyone who asks whether a quarter wheel, a rigid tyre or coarse grains can stand for the vehicle.

    scripts/fidelity_study.py run out/fidelity                              # on a CPU; --device cuda on a GPU
    scripts/fidelity_study.py report data/hmmwv_32mm_unsolved/fidelity_trials        # this table, from the trials kept there

{count} points of the HMMWV's dataset, those nearest the boundary between passing (go, slow-go) and not, are driven again. The
reference is the dataset's own trials: {reference}. {passing} of them pass, with a mean slip of {slip:.2f} and a mean sinkage of
{sinkage:.0f} mm.

Slip and sinkage are mean changes from the reference with their standard errors; slip above 2 counts as 2.

| driven | trials | pass | labels that differ | now pass, now fail | slip | sinkage [mm] |
|---|---|---|---|---|---|---|"""


def of_points(trials, points):
    """The first trial of every point, with the point's number as its index."""
    same = lambda a, b: all(abs(float(a[n]) - float(b[n])) < 1e-9 for n in ranges())
    return [{**t, "index": str(k)} for k, p in enumerate(points) for t in trials if t["replicate_of"] == "-1" and same(t, p)]


def report(options):
    points = read_points()
    base = [{**p, "index": str(k)} for k, p in enumerate(points)]
    lines = HEADER.format(count=len(points), reference=REFERENCE, passing=sum(map(passes, points)),
                          slip=statistics.mean(map(slip_of, points)),
                          sinkage=1e3 * statistics.mean(number(p["sinkage"]) for p in points)).split("\n")
    rows = []
    for name, *_ in variants():
        table = folder_of(options.folder, name) / "trials.csv"
        if not table.exists():
            continue
        with open(table) as file:
            trials = of_points(list(csv.DictReader(file)), points)
        c = compare(base, trials, ranges())
        rows.append({"variant": name, **c})
        unknown = f", {c['unknown']} unknown" if c["unknown"] else ""
        lines.append(f"| {name} | {c['trials']}{unknown} | {sum(map(passes, trials))} | {changes_text(c)} |")
    write_report(options.docs / "fidelity.md", lines, ["variant", *compare(base, base, ranges())], rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    chosen = commands.add_parser("points")
    chosen.add_argument("--out", type=pathlib.Path, default=DATA / "fidelity_points.csv")
    chosen.add_argument("--points", type=int, default=30)
    runs = commands.add_parser("run")
    runs.add_argument("folder", type=pathlib.Path)
    runs.add_argument("--device", default="cpu")
    runs.add_argument("--threads", type=int, default=0, help="0: all")
    runs.add_argument("--only", nargs="+", help="folder names of variants")
    for command in (chosen, runs):
        command.add_argument("--gonogo", default=str(HERE / "build/cpu-release/gonogo"))
    reports = commands.add_parser("report")
    reports.add_argument("folder", type=pathlib.Path)
    reports.add_argument("--docs", type=pathlib.Path, default=HERE / "docs")
    options = parser.parse_args()
    {"points": choose_points, "run": run, "report": report}[options.command](options)


if __name__ == "__main__":
    main()
