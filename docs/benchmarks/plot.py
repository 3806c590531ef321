"""Plots history.csv beside this file into history.png: docs/benchmarks/plot.py. Needs Python and matplotlib.

One panel per kind of scene (the part of `scene` before the slash, GPU and CPU apart), log axis, revisions in the order
of their commits. Drawn are the scenes of PANELS, which were measured at two revisions or more; several runs of one
revision are shown as points, the line goes through their median.
"""
import csv
import pathlib
import statistics

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import FuncFormatter  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
ITERATION, WHOLE = "contact-iteration, solver", "contact-iteration, whole step"
STEADY = "trials per GPU and hour, steady"
FIRST = "1 world, first 0.5 s, "

# Title, unit of the axis, and per line: label, scene, metric, machine ("" takes all).
PANELS = [
    ("Beds at rest, H200: contact-iteration, solver", "ns", [
        ("40 worlds", "bed/40 worlds", ITERATION, ""),
        ("40 worlds, no rolling", "bed/40 worlds, no rolling", ITERATION, ""),
        ("512 worlds", "bed/512 worlds", ITERATION, ""),
        ("4,096 tiny worlds", "bed/4,096 tiny worlds", ITERATION, ""),
        ("40 copies, one world", "bed/40 copies in one world", ITERATION, "")]),
    ("Beds at rest, one core: contact-iteration, whole step", "ns", [
        ("50 mm, host of the H200", "bed/grain 0.05, 1 core", WHOLE, "host of the H200"),
        ("32 mm, host of the H200", "bed/grain 0.032, 1 core", WHOLE, "host of the H200"),
        ("50 mm, EPYC", "bed/grain 0.05, 1 core", WHOLE, "EPYC, 2 cores"),
        ("50 mm, another machine", "bed/grain 0.05, 1 core", WHOLE, "another machine")]),
    ("Wheel scene, H200: step", "ms", [
        ("substeps x iterations: 14 x 2 (default)", f"wheel/{FIRST}14 x 2", "step", ""),
        ("20 x 2", f"wheel/{FIRST}20 x 2", "step", ""),
        ("1 x 50", f"wheel/{FIRST}1 x 50", "step", ""),
        ("1 x 10", f"wheel/{FIRST}1 x 10", "step", "")]),
    ("Many bodies, H200: step", "ms", [
        ("tank, 1,000,000", "many bodies/tank, 1,000,000 spheres", "step", ""),
        ("tank, 200,000", "many bodies/tank, 200,000 spheres", "step", ""),
        ("silo, 128,000", "many bodies/silo, 128,000 spheres", "step", ""),
        ("silo, 16,000", "many bodies/silo, 16,000 spheres", "step", "")]),
    ("Search for contacts", "ms", [
        ("6,900,000 spheres, H200", "search/collide, 6,900,000 spheres", "search", ""),
        ("25,000 spheres of 4 mm to 2 m, one core", "search/25,000 spheres of 4 mm to 2 m, busy", "search", ""),
        ("two rings of 65,536 triangles, one core", "search/two rings of 65,536 triangles, busy", "search", ""),
        ("two rings of 4,096 triangles, one core", "search/two rings of 4,096 triangles, busy", "search", "")]),
    ("Block Gibbs sampling, H200: unit updates", "1/ns", [
        ("65,536 chains, 168 x 168 units", "gibbs/65,536 chains", "unit updates", "")]),
    ("Campaigns, H200: trials per GPU and hour", "1/h", [
        ("quarter_wheel_32mm", "campaign/quarter_wheel_32mm", STEADY, ""),
        ("hmmwv_32mm", "campaign/hmmwv_32mm", STEADY, "")]),
    ("Maps and routes, EPYC of two cores", "s", [
        ("map, 10,000 x 10,000 cells, busy", "map/10,000 x 10,000 cells, busy", "time", ""),
        ("route, 10 million cells, processor time",
         "map/route over 10,004,569 cells, whole command", "processor time", ""),
        ("route, search alone", "map/route over 10,004,569 cells, search alone", "time", "")]),
]


def runs_of(rows, scene, metric, machine):
    """Values by revision, revisions in the order of the file."""
    runs = {}
    for row in rows:
        if row["scene"] == scene and row["metric"] == metric and machine in ("", row["machine"]):
            runs.setdefault(row["revision"], []).append(float(row["value"]))
    return runs


def draw(axes, rows, title, unit, series):
    order = list(dict.fromkeys(row["revision"] for row in rows))
    lines = [(label, runs_of(rows, scene, metric, machine)) for label, scene, metric, machine in series]
    for label, runs in lines:
        if not runs:
            raise SystemExit(f"history.csv has no rows for \"{label}\" of the panel \"{title}\"")
    used = sorted({revision for _, runs in lines for revision in runs}, key=order.index)
    place = {revision: x for x, revision in enumerate(used)}
    for label, runs in lines:
        line, = axes.plot([place[r] for r in runs], [statistics.median(v) for v in runs.values()], lw=1.4, label=label)
        points = [(place[r], value) for r, values in runs.items() for value in values]
        axes.plot(*zip(*points), "o", ms=4, color=line.get_color())
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    axes.set_ylim(low / 1.15, high * (1.6 if len(lines) > 2 else 1.3))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"{y:g}"))
    # Short axes name values between the powers of ten, too.
    named = "123456789" if high / low < 4 else "1235" if high / low < 20 else ""
    axes.yaxis.set_minor_formatter(FuncFormatter(lambda y, _: f"{y:g}" if f"{y:.0e}"[0] in named else ""))
    axes.set_xticks(range(len(used)), used, rotation=60, ha="right", family="monospace", fontsize=7)
    axes.set_xlim(-0.5, len(used) - 0.5)
    axes.set_ylabel(unit)
    axes.set_title(title, fontsize=10)
    axes.tick_params(axis="y", which="both", labelsize=8)
    axes.grid(True, which="major", alpha=0.35)
    axes.legend(fontsize=7, frameon=False, loc="best")


def main():
    with open(HERE / "history.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    figure, axes = plt.subplots(4, 2, figsize=(11, 14), layout="constrained")
    for panel, (title, unit, series) in zip(axes.flat, PANELS):
        draw(panel, rows, title, unit, series)
    figure.savefig(HERE / "history.png", dpi=90)


if __name__ == "__main__":
    main()
