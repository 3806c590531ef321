"""Draws soil_angles.png beside this file: what one soil shows in each test, by the 32 mm soil table.

    docs/images/soil_angles.py        needs Python and matplotlib
"""
import json
import math
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent
TABLE = HERE.parent.parent / "configs/soils/calibration_32mm.json"
CURVES = [
    ("triaxial compression, peak: what friction_angle means", "friction_angle", "#1b4965", "-"),
    ("plane of shear, peak: box, ring, bevameter", "shear_peak_angle", "#c8553d", "-"),
    ("triaxial compression, steady", "steady_friction_angle", "#1b4965", "--"),
    ("plane of shear, steady", "shear_steady_angle", "#c8553d", "--"),
]


def main():
    table = json.loads(TABLE.read_text())
    packings = len(table["packing"])
    fig, axes = plt.subplots(1, packings, figsize=(11, 4.2), sharey=True)
    for p, axis in enumerate(axes):
        rows = table["response"][p::packings]
        peak = [row["friction_angle_deg"] for row in rows]
        for label, key, colour, style in CURVES:
            angle = [row[f"{key}_deg"] for row in rows]
            error = [row.get(f"{key}_error_deg", 0) for row in rows]
            axis.errorbar(peak, angle, yerr=error, color=colour, linestyle=style, marker="o", markersize=3,
                          linewidth=1.4, elinewidth=0.8, label=label)
        line = [math.degrees(math.atan(math.sin(math.radians(x)))) for x in peak]
        axis.plot(peak, line, color="0.5", linewidth=1, linestyle=":",
                  label="tan(plane of shear) = sin(triaxial), no dilation")
        axis.set_title(f"{('loosest', 'middle', 'densest')[p]} packing", fontsize=10)
        axis.set_xlabel("triaxial peak [deg]")
        axis.grid(color="0.9")
        axis.spines[["top", "right"]].set_visible(False)
    axes[0].set_ylabel("angle that the test shows [deg]")
    axes[0].legend(fontsize=7.5, frameon=False, loc="upper left")
    fig.tight_layout()
    fig.savefig(HERE / "soil_angles.png", dpi=110)


if __name__ == "__main__":
    main()
