#!/usr/bin/env python3
"""Points of a family's study where real vehicles are: a CSV design beside its Sobol sequence (docs/vehicles.md).

    python3 -m venv out/points && out/points/bin/pip install scipy
    out/points/bin/python scripts/family_points.py --count 512 --out configs/studies/wheeled_family_real_32mm.csv

Each point's vehicle lies between two of data/wheeled_vehicles/vehicles.csv: lengths and ratios are mixed as logarithms,
axles are those of the first. Vehicles with trials of their own, which score the family, are left out of the table. Soil,
slope, speed, force and the place of the centre of mass fill the study's ranges evenly.
"""
import argparse
import csv
import json
import math

from family_sanity import ROOT, numbers
from scipy.stats import qmc

DRIVEN = ("HMMWV", "VIPER", "MGRU3", "Argo")  # they score the family
STUDY = ROOT / "configs/studies/wheeled_family_32mm.json"
MIXED = ["load_number", "width_ratio", "deflection_ratio", "lug_ratio", "axle_gap_ratio", "track_ratio", "centre_height_ratio",
         "clearance_ratio", "power_number"]


def between(a, b, share, ranges):
    """Of two vehicles' numbers; a number that one of them lacks (rigid, smooth) is that of the first."""
    def mix(name):
        low, high = ranges[name]
        if min(a[name], b[name]) <= 0:
            return min(max(a[name], low), high)
        return min(max(math.exp((1 - share) * math.log(a[name]) + share * math.log(b[name])), low), high)
    return {name: mix(name) for name in MIXED} | {"axles": a["axles"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=512)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", required=True, help="CSV file")
    options = parser.parse_args()
    ranges = json.loads(STUDY.read_text())["design"]["ranges"]
    with open(ROOT / "data/wheeled_vehicles/vehicles.csv") as file:
        table = [numbers(row) for row in csv.DictReader(file) if not row["name"].startswith(DRIVEN)]
    even = [name for name in ranges if name not in MIXED and name != "axles"]
    samples = qmc.Sobol(len(even) + 3, seed=options.seed).random(options.count)
    with open(options.out, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(ranges)
        for sample in samples:
            first, second = (table[int(u * len(table))] for u in sample[:2])
            point = between(first, second, sample[2], ranges)
            for name, u in zip(even, sample[3:]):
                point[name] = ranges[name][0] + u * (ranges[name][1] - ranges[name][0])
            writer.writerow(f"{point[name]:.6g}" for name in ranges)
    print(f"{options.out}: {options.count} points between {len(table)} vehicles")


if __name__ == "__main__":
    main()
