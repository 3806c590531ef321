#!/usr/bin/env python3
"""Gross traction of smooth tyres on sand against the sand number of the Waterways Experiment Station, whose cone gradient was measured in
the same virtual beds.

  scripts/sand_number.py points > configs/studies/sand_number_32mm.csv
  scripts/gpu_campaign.sh configs/studies/sand_number_32mm.json out/sand_number 300 64
  gonogo campaign snapshot out/sand_number --out out/sand_number.h5 && gonogo dataset export out/sand_number.h5 --out out/sand_number.csv
  scripts/sand_number.py report out/sand_number.csv --table configs/soils/calibration_32mm.json

N = G (b D)^(3/2) / W * deflection / section height, and T = X - X Y / (N + 10 + Y) with X = 0.66, Y = 4.71 + 1.72 / slip is the fit of the
DROVE records (Mason et al. 2016, as vehicle/semi_empirical/traction.h has it). T is torque over load and loaded radius. Needs Python alone.
"""
import argparse, csv, json, math, pathlib, statistics, sys

SECTION = {0.2: 0.20, 0.3: 0.21, 0.4: 0.22, 0.5: 0.22}  # height of the section over the diameter, by width over diameter
DEFLECTIONS = (0, 0.12, 0.24, 0.35)                     # over the section's height
SOILS = ((28, 0.2), (33, 0.5), (38, 0.8))               # triaxial angle [deg], relative density
LOADS = (1, 2.5)                                        # load numbers W / (rho g b D^2), in turn
FIXED = {"cohesion": 0, "tyre_friction": 0.7, "bed_depth": 0.4, "commanded_speed": 1, "single_wheel_slip": 0.2,
         "single_wheel_slip_angle": 0, "lug_ratio": 0}


def points():
    rows = []
    for shape, width in enumerate(SECTION):
        for k, deflection in enumerate(DEFLECTIONS):
            for soil, (angle, density) in enumerate(SOILS):
                rows.append({"friction_angle": angle, "relative_density": density, "load_number": LOADS[(shape + k + soil) % 2],
                             "width_ratio": width, "deflection_ratio": round(deflection * SECTION[width], 4)} | FIXED)
    writer = csv.DictWriter(sys.stdout, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)


def gradient(table, angle, density):
    """Of the cone index over unit weight: along a packing's contact levels its logarithm is linear in the angle."""
    packing = min(range(len(table["packing"])), key=lambda p: abs(table["packing"][p]["relative_density"] - density))
    levels = sorted((r["friction_angle_deg"], r["cone_gradient_over_unit_weight"])
                    for r in table["response"] if r["packing"] == packing and r["cone_gradient_over_unit_weight"] > 0)
    for (low, a), (high, b) in zip(levels, levels[1:]):
        if low <= angle <= high:
            return a * (b / a) ** ((angle - low) / (high - low))
    raise SystemExit(f"sand_number: the table has no cones around {angle} degrees in packing {packing}")


def report(options):
    table = json.loads(options.table.read_text())
    if "cone_gradient_over_unit_weight" not in table["response"][0]:
        raise SystemExit(f"sand_number: {options.table}: holds no cones; add them by 'gonogo soil calibrate --onto'")
    misses = []
    print(f"{'b/D':>4} {'d/h':>5} {'load':>5} {'angle':>5} {'G/gamma':>8} {'N':>6} {'slip':>5} {'formula':>8} {'gonogo':>7}")
    with open(options.trials, newline="") as file:
        for row in csv.DictReader(file):
            value = lambda name: float(row[name])
            width, load, slip = round(value("width_ratio"), 3), value("load_number"), value("single_wheel_slip")
            deflection = value("deflection_ratio") / SECTION[width]
            g = gradient(table, value("friction_angle"), value("relative_density"))
            number = g * math.sqrt(width) * deflection / load
            x, y = 0.66, 4.71 + 1.72 / slip
            formula = x - x * y / (number + 10 + y)
            weight = load * 1600 * 9.81 * width                              # on the family's wheel of 1 m
            gross = value("mean_torque") / (weight * (0.5 - value("deflection_ratio")))
            misses.append(gross - formula)
            print(f"{width:4.1f} {deflection:5.2f} {load:5.1f} {value('friction_angle'):5.0f} {g:8.1f} {number:6.1f} {slip:5.2f} "
                  f"{formula:8.3f} {gross:7.3f}")
    rms = math.sqrt(statistics.fmean(m * m for m in misses))
    print(f"{len(misses)} tyres: rms {rms:.3f} of the load, bias {statistics.fmean(misses):+.3f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("points", help="the study's points as CSV")
    told = commands.add_parser("report", help="each tyre, and the rms over all")
    told.add_argument("trials", type=pathlib.Path, help="CSV of the trials, by gonogo dataset export")
    told.add_argument("--table", type=pathlib.Path, required=True, help="soil table with cones")
    options = parser.parse_args()
    points() if options.command == "points" else report(options)


if __name__ == "__main__":
    main()
