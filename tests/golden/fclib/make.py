#!/usr/bin/env python3
"""Remakes problems.json: sums over the problems of tests/data/fclib, read without our readers.

HDF5 files by the text that h5dump prints, .dat files by the order of their words; plain Python, no packages. Global
problems are reduced with the elimination below. Run from anywhere: python3 tests/golden/fclib/make.py
"""
import json, math, pathlib, re, subprocess

HERE = pathlib.Path(__file__).resolve().parent
DATA = HERE.parent.parent / "data" / "fclib"


def h5(path, name, kind=float):
    text = subprocess.run(["h5dump", "-y", "-m", "%.17g", "-d", name, str(path)], capture_output=True, text=True,
                          check=True).stdout
    body = re.search(r"DATA \{(.*?)\}", text, re.S).group(1)
    return [kind(word) for word in body.replace(",", " ").split()]


def stored_matrix(path, group):
    rows, columns, kind = (h5(path, f"{group}/{n}", int)[0] for n in ("m", "n", "nz"))
    p, i, x = h5(path, group + "/p", int), h5(path, group + "/i", int), h5(path, group + "/x")
    if kind >= 0:
        entries = [(i[k], p[k], x[k]) for k in range(kind)]
    else:
        entries = [(i[k], line, x[k]) if kind == -1 else (line, i[k], x[k])
                   for line in range(len(p) - 1) for k in range(p[line], p[line + 1])]
    return rows, columns, entries


def solve(rows, entries, right_sides):
    """Gauss-Jordan on dictionaries, one connected part of M after another; M is block diagonal in these files."""
    matrix = [dict() for _ in range(rows)]
    for r, c, v in entries:
        matrix[r][c] = matrix[r].get(c, 0.0) + v
    for column in range(rows):
        pivot = max((r for r in range(column, min(rows, column + 6))), key=lambda r: abs(matrix[r].get(column, 0.0)))
        matrix[column], matrix[pivot] = matrix[pivot], matrix[column]
        right_sides[column], right_sides[pivot] = right_sides[pivot], right_sides[column]
        scale = matrix[column][column]
        for r in range(max(0, column - 6), min(rows, column + 6)):
            factor = matrix[r].get(column, 0.0) / scale
            if r == column or factor == 0.0:
                continue
            for c, v in matrix[column].items():
                matrix[r][c] = matrix[r].get(c, 0.0) - factor * v
            for c, v in right_sides[column].items():
                right_sides[r][c] = right_sides[r].get(c, 0.0) - factor * v
    return [{c: v / matrix[r][r] for c, v in right_sides[r].items()} for r in range(rows)]


def reduced(path, group):
    rows, _, m = stored_matrix(path, group + "/M")
    _, columns, h = stored_matrix(path, group + "/H")
    f, w = h5(path, group + "/vectors/f"), h5(path, group + "/vectors/w")
    right = [dict() for _ in range(rows)]
    for r, c, v in h:
        right[r][c] = right[r].get(c, 0.0) + v
    for r in range(rows):
        right[r]["f"] = f[r]
    x = solve(rows, m, right)
    q, entries = list(w), []
    for r, c, v in h:
        q[c] += v * x[r].get("f", 0.0)
        entries += [(c, column, v * value) for column, value in x[r].items() if column != "f"]
    return entries, q


def read_hdf5(path):
    groups = subprocess.run(["h5dump", "-n", str(path)], capture_output=True, text=True, check=True).stdout
    mu_r = []
    if "/fclib_local\n" in groups:
        group = "/fclib_local"
        entries, q = stored_matrix(path, group + "/W")[2], h5(path, group + "/vectors/q")
    else:
        group = "/fclib_global_rolling" if "/fclib_global_rolling\n" in groups else "/fclib_global"
        entries, q = reduced(path, group)
        if "rolling" in group:
            mu_r = h5(path, group + "/vectors/mu_r")
    return h5(path, group + "/spacedim", int)[0], entries, q, h5(path, group + "/vectors/mu"), mu_r


def read_text(path):
    words = iter(path.read_text().split())
    take = lambda kind, count: [kind(next(words)) for _ in range(count)]
    dimension, contacts, storage, rows, columns = take(int, 5)
    entries = []
    if storage == 0:
        take(int, 2)
        values = take(float, rows * columns)
        entries = [(k % rows, k // rows, values[k]) for k in range(rows * columns)]
    else:
        blocks, lines, block_columns = take(int, 3)
        row_end, column_end = [0] + take(int, lines), [0] + take(int, block_columns)
        starts, count = take(int, 2)
        first, column = take(int, starts), take(int, count)
        for line in range(lines):
            for k in range(first[line], first[line + 1]):
                assert int(next(words)) == k
                for c in range(column_end[column[k]], column_end[column[k] + 1]):
                    for r in range(row_end[line], row_end[line + 1]):
                        entries.append((r, c, float(next(words))))
    return dimension, entries, take(float, rows), take(float, contacts), []


def sums(dimension, entries, q, mu, mu_r):
    """Every entry counts with a weight of its place, so that a transposed or shifted one shows."""
    return {
        "dimension": dimension,
        "contacts": len(mu),
        "trace_w": math.fsum(v for r, c, v in entries if r == c),
        "weighted_w": math.fsum((r + 1) * math.cos(c) * v for r, c, v in entries),
        "weighted_q": math.fsum((r + 1) * v for r, v in enumerate(q)),
        "length_q": math.sqrt(math.fsum(v * v for v in q)),
        "sum_mu": math.fsum(mu),
        "sum_mu_r": math.fsum(mu_r),
    }


problems = {}
for path in sorted(DATA.glob("*.hdf5")) + sorted(DATA.glob("*.dat")):
    problems[path.name] = sums(*(read_hdf5(path) if path.suffix == ".hdf5" else read_text(path)))
(HERE / "problems.json").write_text(json.dumps(problems, indent=2) + "\n")
