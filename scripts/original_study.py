#!/usr/bin/env python3
"""The original study's bin at 24 points of its ranges, beside the reference vehicle at the same inputs.

  scripts/original_study.py points                              # configs/studies/original_inputs.txt, original.csv
  scripts/original_study.py run out/original [--gpu] [--line 3] # one results_<line>.out a run; goes on where it stopped
  gonogo campaign run configs/studies/original.json --out out/original_reference
  scripts/original_study.py report out/original out/original_reference      # data/original/labels.csv, a table in Markdown

The five inputs and their ranges are those of R. Serban's go_nogo programs (fork of Project Chrono, revision 6e9a73d694 of
2017-06-25): slope, grain radius, density, friction, cohesion. `gonogo original` runs its bin, vehicle and stop rules.
`configs/studies/original.json` drives the reference, the whole HMMWV on compliant tyres over grains of 32 mm, at the same
inputs: friction of spheres becomes the friction angle that the calibration table measured for them, cohesion of contacts
that of the soil. Neither radius nor density is a variable there. Needs Python alone.
"""
import argparse, csv, json, pathlib, subprocess

from fidelity_study import export
from label_quality import passes

HERE = pathlib.Path(__file__).resolve().parent.parent
INPUTS = HERE / "configs/studies/original_inputs.txt"
POINTS = HERE / "configs/studies/original.csv"
TABLE = HERE / "configs/soils/calibration_32mm.json"
LABELS = HERE / "data/original/labels.csv"
COUNT = 24
RANGES = {"slope_deg": (0, 30), "radius_mm": (4, 10), "density": (1500, 3000), "friction": (0.2, 1), "cohesion_kPa": (100, 1000)}
TYRE_FRICTION = 0.8         # of 2017; the larger of tyre and grains acts
GREATEST_PULL = 200.0       # kPa between grains; the table serves up to twice the stress under a wheel, 110 kPa
SHALLOWEST_BED = 0.12       # m, of the reference
SPEED = 1.2                 # m/s, the slowest of the reference; the original asks for 7 m in 6.5 s
LABEL_OF = {"Reached maximum x position": "go", "Vehicle sliding backward": "no_go", "Reached maximum time": "no_go",
            "Simulation failed": "unknown"}


def halton(index, base):
    value, share = 0.0, 1.0
    while index:
        share /= base
        value += share * (index % base)
        index //= base
    return value


def inputs():
    """Rows of the original's input file: Halton points of bases 2, 3, 5, 7, 11, from the first on."""
    scaled = lambda k, base, span: span[0] + (span[1] - span[0]) * halton(k, base)
    return [[round(scaled(k, base, span), 4) for base, span in zip((2, 3, 5, 7, 11), RANGES.values())] for k in range(1, COUNT + 1)]


def of_table(levels, friction, key):
    """Linear between the levels of smooth-rolling spheres; held at the ends."""
    below = max((l for l in levels if l["friction"] <= friction), key=lambda l: l["friction"])
    above = min((l for l in levels if l["friction"] >= friction), key=lambda l: l["friction"], default=below)
    share = 0 if above is below else (friction - below["friction"]) / (above["friction"] - below["friction"])
    return below[key] + share * (above[key] - below[key])


def reference_point(row, levels):
    slope, _, _, friction, cohesion = row
    soil_cohesion = of_table(levels, friction, "cohesion_gain") * min(cohesion, GREATEST_PULL)
    return {"slope_along": slope, "slope_across": 0, "friction_angle": round(of_table(levels, friction, "friction_angle_deg"), 3),
            "cohesion": round(soil_cohesion, 3), "relative_density": 0.5, "payload": 0,
            "tyre_friction": max(friction, TYRE_FRICTION), "bed_depth": SHALLOWEST_BED, "commanded_speed": SPEED}


def write_points(_):
    levels = [l for l in json.loads(TABLE.read_text())["contact"] if l["rolling_friction"] == 0]
    rows = inputs()
    INPUTS.write_text("".join(" ".join(f"{v:g}" for v in row) + "\n" for row in rows))
    points = [reference_point(row, levels) for row in rows]
    with open(POINTS, "w", newline="") as file:
        writer = csv.DictWriter(file, points[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(points)


def run(options):
    lines = [options.line] if options.line else range(1, COUNT + 1)
    failed = []
    for k in lines:
        file = options.folder / f"results_{k}.out"
        if file.exists() and "Simulation failed" not in file.read_text():
            continue
        print(f"run {k} of {COUNT}", flush=True)
        command = [options.gonogo, "original", str(INPUTS), "--line", str(k), "--out", str(options.folder)]
        failed.append(subprocess.run(command + (["--gpu"] if options.gpu else [])).returncode != 0)
    if any(failed):
        raise SystemExit(f"{sum(failed)} runs failed; the same command tries them again")


def read_run(folder, k):
    """Stop sentence, time [s], place [m] and speed [m/s] along the way at the end."""
    lines = (folder / f"results_{k}.out").read_text().strip().splitlines()
    samples = [l.split() for l in lines if l[0] in "0123456789.-"]
    stop = next(s for s in LABEL_OF if any(s in l for l in lines))
    t, _, _, x, _, _, speed = map(float, samples[-1][:7])
    return {"stop": stop, "label": LABEL_OF[stop], "time_s": t, "x_m": x, "speed_m_per_s": speed}


def reference_trials(options):
    trials = export(options.gonogo, options.reference / "dataset.h5", options.reference / "trials.csv")
    return {int(t["index"]): t for t in trials}


def report(options):
    reference = reference_trials(options)
    rows = []
    for k, row in enumerate(inputs(), 1):
        if not (options.folder / f"results_{k}.out").exists():
            continue
        trial = reference[k - 1]
        rows.append({"line": k, **dict(zip(RANGES, row)), **read_run(options.folder, k), "reference": trial["verdict"],
                     "reference_reason": trial["reason"], "reference_slip": trial["slip"]})
    LABELS.parent.mkdir(exist_ok=True)
    with open(LABELS, "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    print("| slope [deg] | radius [mm] | density [kg/m^3] | friction | cohesion [kPa] | original ends | at x [m], t [s] | reference |")
    print("|---|---|---|---|---|---|---|---|")
    for r in sorted(rows, key=lambda r: r["slope_deg"]):
        print(f"| {r['slope_deg']:.1f} | {r['radius_mm']:.1f} | {r['density']:.0f} | {r['friction']:.2f} | {r['cohesion_kPa']:.0f} "
              f"| {r['stop']} | {r['x_m']:.2f}, {r['time_s']:.2f} | {r['reference']} ({r['reference_reason']}) |")
    reference_passes = lambda r: passes({"verdict": r["reference"]})
    known = [r for r in rows if r["label"] != "unknown"]
    same = sum((r["label"] == "go") == reference_passes(r) for r in known)
    print(f"\n{same} of {len(known)} labels are equal; {sum(r['label'] == 'go' for r in rows)} pass in the original, "
          f"{sum(reference_passes(r) for r in rows)} in the reference")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    chosen = commands.add_parser("points")
    chosen.set_defaults(call=write_points)
    runs = commands.add_parser("run")
    runs.add_argument("folder", type=pathlib.Path)
    runs.add_argument("--line", type=int, default=0, help="0: all")
    runs.add_argument("--gpu", action="store_true")
    runs.set_defaults(call=run)
    reports = commands.add_parser("report")
    reports.add_argument("folder", type=pathlib.Path)
    reports.add_argument("reference", type=pathlib.Path)
    reports.set_defaults(call=report)
    for command in (runs, reports):
        command.add_argument("--gonogo", default=str(HERE / "build/cpu-release/gonogo"))
    options = parser.parse_args()
    options.call(options)


main()
