#!/usr/bin/env python3
"""Whether two maps of one region agree: class equal in enough cells, P(go) close in the mean.

    scripts/map_agreement.py out/demo/map out/reference

Cells where both maps are unknown count neither way. Exit status 1 where a limit is missed. Needs numpy and rasterio.
"""
import argparse
import sys
from pathlib import Path

import numpy
import rasterio

EQUAL_CLASS, P_GO_DIFFERENCE = 0.85, 0.08  # least share of cells [-], largest mean |difference| [-]
UNKNOWN = 4  # code of the class in go.tif (docs/map.md)


def layer(folder, name):
    with rasterio.open(folder / name) as source:
        return source.read(1, masked=True), source.transform


def agreement(first, second):
    """Share of cells of equal class, mean |difference of P(go)|, number of cells known in either map."""
    (a, place), (b, other) = layer(first, "go.tif"), layer(second, "go.tif")
    if a.shape != b.shape or place != other:
        raise SystemExit(f"{first} and {second}: maps of different grids; make both of one region")
    a, b = a.filled(UNKNOWN), b.filled(UNKNOWN)
    known = (a != UNKNOWN) | (b != UNKNOWN)
    if not known.any():
        raise SystemExit(f"{first} and {second}: no cell is known in either; nothing to compare")
    p, q = (layer(folder, "p_go.tif")[0].filled(numpy.nan) for folder in (first, second))
    difference = numpy.abs(p - q)[known]
    return float((a == b)[known].mean()), float(numpy.nanmean(difference)), int(known.sum())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("first", type=Path)
    parser.add_argument("second", type=Path)
    options = parser.parse_args()
    equal, difference, cells = agreement(options.first, options.second)
    print(f"class equal in {100 * equal:.1f} % of {cells} cells, mean |difference of P(go)| {difference:.4f}")
    return 0 if equal >= EQUAL_CLASS and difference <= P_GO_DIFFERENCE else 1


if __name__ == "__main__":
    sys.exit(main())
