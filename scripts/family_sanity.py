#!/usr/bin/env python3
"""Steepest slopes that a family's model gives ten vehicles on three soils, and their directions (docs/vehicles.md).

    scripts/family_sanity.py --model data/wheeled_family_32mm

A row is a vehicle of data/wheeled_vehicles/vehicles.csv on a soil: the steepest slope whose P(go) is at least 0.5, and
what it becomes with a third of the power, half as much load again, and tyres 1.3 as wide under the same load. None of
the first two may be steeper, the third not less steep, beyond half a degree. Published limits stand beside.
"""
import argparse
import csv
import json
import math
import pathlib
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
DENSITY = 1600  # kg/m^3
VEHICLES = ["Clearpath Husky A200", "Clearpath Warthog", "Polaris RZR 4 (2010)", "HMMWV M998", "LMTV M1078A1P2",
            "HEMTT M977", "MER", "MSL Curiosity", "Lunar Roving Vehicle", "VIPER"]
# friction angle [deg], cohesion [kPa at wheels of 1 m on the Earth], relative density
SOILS = {"loose sand": (30, 0.1, 0.1), "dense sand": (40, 0.1, 0.9), "firm loam": (38, 14, 0.8)}
# steepest slopes [deg]: lowest and highest that agree, and who says so
PUBLISHED = {
    ("MER", "loose sand"): (8, 20, "a little less than Curiosity (same source)"),
    ("MSL Curiosity", "loose sand"): (8, 20, "about 15 deg in soft sand (NASA, techbriefs.tv/video/Martian-Dune-Buggy)"),
    ("Lunar Roving Vehicle", "dense sand"): (19, 31, "25 deg"),
    ("HMMWV M998", "firm loam"): (29, 90, "60 % grade"),
}
SPEED = 0.4  # over sqrt(g D): a slower vehicle is asked with the force that its power gives at its own top speed
DEPTH = 0.4  # of soft soil over the diameter
SLOPES = [0.5 * k for k in range(71)]


def numbers(row):
    def value(key):
        return float(row[key] or 0)
    g, mass, d, axles = value("gravity_m_s2"), value("mass_kg"), value("diameter_m"), int(value("axles"))
    width = value("width_m")
    return {"load_number": mass / (2 * axles) / (DENSITY * width * d * d), "width_ratio": width / d,
            "deflection_ratio": value("deflection_m") / d, "lug_ratio": value("lug_m") / d, "axles": axles,
            "axle_gap_ratio": value("wheelbase_m") / d - (axles - 1), "track_ratio": value("track_m") / d,
            "centre_height_ratio": value("centre_height_m") / d, "centre_share": 0.5,
            "clearance_ratio": value("clearance_m") / d, "force_number": 1.0,
            "power_number": value("power_W") / (mass * g * math.sqrt(g * d)) * max(1, SPEED * math.sqrt(g * d) / value("top_speed_m_s"))}


def inside(n, ranges):
    return {k: min(max(x, ranges[k][0]), ranges[k][1]) for k, x in n.items()}


def changed(n, power=1.0, load=1.0, width=1.0):
    """`load`: of the mass; wider tyres carry the same load on more soil."""
    n = dict(n)
    n["power_number"] *= power / load
    n["force_number"] /= load
    n["load_number"] *= load / width
    n["deflection_ratio"] *= load
    n["width_ratio"] *= width
    return n


def steepest(gonogo, model, cases, folder):
    names = list(cases[0])
    asked, answered = folder / "points.csv", folder / "answers.csv"
    with open(asked, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["slope_along", *names])
        for case in cases:
            writer.writerows([slope, *case.values()] for slope in SLOPES)
    subprocess.run([gonogo, "infer", "--model", model, "--csv", str(asked), "--out", str(answered)], check=True,
                   stdout=subprocess.DEVNULL)
    with open(answered) as file:
        p = [float(row["p_go"]) for row in csv.DictReader(file)]
    found = []
    for k in range(len(cases)):
        passed = [s for s, q in zip(SLOPES, p[k * len(SLOPES):(k + 1) * len(SLOPES)]) if q >= 0.5]
        found.append(max(passed, default=-1))
    return found


def read_family(file):
    with open(file) as text:
        family = json.load(text)
    return family["ranges"], family["diameter_m"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--model", required=True)
    parser.add_argument("--gonogo", default="build/cpu-release/gonogo")
    parser.add_argument("--family", default=ROOT / "configs/families/wheeled_half_metre.json", help="that the trials drove")
    options = parser.parse_args()
    with open(ROOT / "data/wheeled_vehicles/vehicles.csv") as file:
        rows = {row["name"]: row for row in csv.DictReader(file)}
    ranges, diameter = read_family(options.family)
    cases, keys = [], []
    for name in VEHICLES:
        for soil, (angle, cohesion, density) in SOILS.items():
            ground = {"slope_across": 0, "friction_angle": angle, "cohesion": cohesion * diameter,
                      "relative_density": density, "tyre_friction": 0.7, "bed_depth": DEPTH * diameter,
                      "commanded_speed": SPEED * math.sqrt(9.81 * diameter), "payload": 0}
            base = inside(numbers(rows[name]), ranges)
            for change in ({}, {"power": 1 / 3}, {"load": 1.5}, {"width": 1.3}):
                cases.append({**ground, **inside(changed(base, **change), ranges)})
            keys.append((name, soil))
    with tempfile.TemporaryDirectory() as folder:
        found = steepest(options.gonogo, options.model, cases, pathlib.Path(folder))
    wrong = 0
    print("| vehicle | soil | steepest [deg] | power / 3 | load x 1.5 | tyres x 1.3 | directions | published |\n|" + "---|" * 8)
    for k, (name, soil) in enumerate(keys):
        base, power, load, width = found[4 * k:4 * k + 4]
        fits = power <= base + 0.5 and load <= base + 0.5 and width >= base - 0.5
        low, high, source = PUBLISHED.get((name, soil), (None, None, ""))
        agrees = "" if low is None else f"{source}: {'agrees' if low <= base <= high else 'differs'}"
        wrong += not fits or agrees.endswith("differs")
        print(f"| {name} | {soil} | {base:g} | {power:g} | {load:g} | {width:g} | {'as known' if fits else 'not'} | {agrees} |")
    print(f"\n{len(keys) - wrong} of {len(keys)} rows are as known")


if __name__ == "__main__":
    main()
