#!/usr/bin/env python3
"""Whether wheels of one shape answer alike at every size and gravity: points of the family of wheels, driven at three diameters
and three gravities with grains, beds, steps, speeds and cohesions scaled.

  scripts/family_scaling.py run out/scaling [--points 20] [--beds 3] [--device cuda] [--together 4] [--grain 32]   # resumes
  scripts/family_scaling.py report out/scaling

Of wheels with the same numbers without dimension, slip is imposed, and pull and side force over the load, sinkage over the diameter and
torque over load times radius must agree (docs/vehicles.md). The scatter is that of beds: each point stands on several. Needs Python alone.
"""
import argparse, concurrent.futures, csv, json, math, pathlib, random, statistics, subprocess

HERE = pathlib.Path(__file__).resolve().parent.parent
STUDY = HERE / "configs/studies/wheel_family_32mm.json"
SIZES = (0.25, 1, 2)        # diameters over the family's
GRAVITIES = (1, 1 / 3, 1 / 6)  # over the Earth's
EARTH = 9.81
DENSITY = 1600              # vehicle/family/numbers.h
SHALLOWEST = 0.21           # [m]: the smallest wheel's bed is above the contract's 0.05 m
LENGTHS, TIMES = ("length_m", "width_m", "deepest_m"), ("park_s", "ramp_s", "minimum_drive_s", "time_limit_s")


def name_of(size, gravity):
    return f"size_{size:g}_gravity_{gravity:.3g}"


def random_points(study, count):
    """Uniform over the study's ranges, always the same."""
    ranges = study["design"]["ranges"] | {"bed_depth": [SHALLOWEST, study["design"]["ranges"]["bed_depth"][1]]}
    draw = random.Random(study["seed"])
    return [{name: draw.uniform(low, high) for name, (low, high) in ranges.items()} for _ in range(count)]


def scaled_study(study, folder, points, beds, size, gravity, grain):
    """Files of one size and gravity; returns the study's."""
    time, speed, stress = math.sqrt(size / gravity), math.sqrt(size * gravity), size * gravity
    where = folder / name_of(size, gravity)
    where.mkdir(parents=True, exist_ok=True)
    family = json.loads((HERE / "configs/families/wheeled.json").read_text())
    family["diameter_m"] *= size
    table = json.loads((HERE / f"configs/soils/calibration_{grain}mm.json").read_text())
    table["grain_diameter_m"] *= size
    (where / "family.json").write_text(json.dumps(family))
    (where / "table.json").write_text(json.dumps(table))
    own = json.loads(json.dumps(study))
    own |= {"study": name_of(size, gravity), "gravity": EARTH * gravity, "vehicle": "family.json", "soil": {"calibration": "table.json"}}
    trial = own["trial"]
    trial["bed"]["length_m"] = max(trial["bed"]["length_m"], 2.95 + 5 * grain / 1000)  # a moving patch leaves four grains
    for key in LENGTHS:
        trial["bed"][key] *= size
    for key in TIMES:
        trial["drive"][key] *= time
    trial["bed"]["settle_s"] *= time
    trial["numerics"]["step_s"] *= time * (grain / 32) ** 0.5
    trial["thresholds"] |= {"residual_m_per_s": 0.2 * max(1, speed), "creep_m_per_s": 0.1 * speed}
    columns = list(points[0])
    factor = {"cohesion": stress, "bed_depth": size, "commanded_speed": speed}
    rows = [[point[c] * factor.get(c, 1) for c in columns] for point in points]
    with open(where / "points.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(row for row in rows for _ in range(beds))
    own["design"] = {"method": "csv", "file": "points.csv", "replicate_every": 0,
                     "fixed": {"slope_along": 0, "slope_across": 0, "payload": 0},
                     "ranges": {c: [min(column), max(column)] for c, column in zip(columns, zip(*rows))}}
    own["compute"] = {"places": 64}
    (where / "study.json").write_text(json.dumps(own, indent=1))
    return where / "study.json"


def run(options):
    options.folder.mkdir(parents=True, exist_ok=True)
    study = json.loads(STUDY.read_text())
    points = random_points(study, options.points)
    files = [scaled_study(study, options.folder, points, options.beds, size, gravity, options.grain)
             for size in SIZES for gravity in GRAVITIES]
    with concurrent.futures.ThreadPoolExecutor(options.together) as pool:
        for _ in pool.map(lambda file: drive(file, options), files):
            pass


def drive(study, options):
    """The campaign of a study, and its trials as a table beside it."""
    campaign, table = study.parent / "campaign", study.parent / "trials.csv"
    commands = (["campaign", "run", study, "--out", campaign, "--device", options.device],
                ["dataset", "export", campaign / "dataset.h5", "--format", "csv", "--out", table])
    for command in commands:
        subprocess.run([options.gonogo, *map(str, command)], check=True)


def measured(row, size, gravity):
    """Numbers without dimension that a trial measured."""
    diameter, weight = size, DENSITY * EARTH * gravity * float(row["load_number"]) * float(row["width_ratio"]) * size**3
    return {"pull": float(row["pull"]), "side force": float(row["side_force"]), "sinkage": float(row["sinkage"]) / diameter,
            "torque": float(row["mean_torque"]) / (weight * diameter / 2), "verdict": row["verdict"] == "go"}


def trials_of(folder, size, gravity):
    """[point][bed] of what was measured; nothing for trials that failed."""
    with open(folder / name_of(size, gravity) / "trials.csv") as file:
        rows = list(csv.DictReader(file))
    points = {}
    for row in rows:
        key = (round(float(row["friction_angle"]), 6), round(float(row["load_number"]), 6))
        points.setdefault(key, []).append(None if row["verdict"] == "unknown" else measured(row, size, gravity))
    return points


def report(options):
    reference = trials_of(options.folder, 1, 1)
    print("size  gravity  differences from size 1, gravity 1: root mean square (scatter of beds)          verdicts alike")
    for size in SIZES:
        for gravity in GRAVITIES:
            if (size, gravity) == (1, 1):
                continue
            other, text = trials_of(options.folder, size, gravity), ""
            for name in ("pull", "side force", "sinkage", "torque"):
                differences, scatter = [], []
                for key, beds in reference.items():
                    one, two = [[b[name] for b in side if b] for side in (beds, other.get(key, []))]
                    if not one or not two:
                        continue
                    differences.append(statistics.mean(two) - statistics.mean(one))
                    scatter += [statistics.stdev(one) ** 2] if len(one) > 1 else []
                rms = math.sqrt(statistics.mean(d * d for d in differences))
                beds_rms = math.sqrt(statistics.mean(scatter)) if scatter else math.nan
                text += f"{name} {rms:.3f} ({beds_rms:.3f})  "
            most = lambda beds: 2 * sum(b["verdict"] for b in beds if b) > sum(1 for b in beds if b)
            alike = sum(most(beds) == most(other.get(key, [])) for key, beds in reference.items())
            print(f"{size:<5g} {gravity:<8.3g} {text} {alike} of {len(reference)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    for name in ("run", "report"):
        command = commands.add_parser(name)
        command.add_argument("folder", type=pathlib.Path)
        command.add_argument("--gonogo", default=str(HERE / "build/cpu-release/gonogo"))
        command.add_argument("--points", type=int, default=20)
        command.add_argument("--beds", type=int, default=3)
        command.add_argument("--device", default="cpu", choices=("cpu", "cuda"))
        command.add_argument("--together", type=int, default=1, help="campaigns side by side: one leaves a GPU waiting for its beds")
        command.add_argument("--grain", type=int, default=32, choices=(32, 90), help="of wheels of 1 m [mm]")
    options = parser.parse_args()
    {"run": run, "report": report}[options.command](options)


if __name__ == "__main__":
    main()
