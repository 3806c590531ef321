#!/usr/bin/env python3
"""What shorter drives would have said of trials whose courses were kept (docs/log/campaign_speed.md).

    scripts/early_end.py data/hmmwv_32mm_fresh/dataset.h5 data/hmmwv_32mm_fresh/campaign.tar.gz
    scripts/early_end.py out/f/dataset.h5 out/f/courses --minimum 2.5 1.5
    scripts/early_end.py data/hmmwv_32mm_fresh/dataset.h5 data/hmmwv_32mm_fresh/campaign.tar.gz --minimum 2 \
        --against data/hmmwv_32mm/converged.h5       # the same points driven otherwise (docs/log/creep.md)

Every course is judged by the rules of docs/trials.md, with the study's `minimum_drive_s` and with shorter ones. Courses
come from `gonogo campaign run --course-every`; a drive ends at a line of its course, so up to one interval late. Rolling
over, failed beds and failed checks leave no trace in a course: these outcomes are taken from the dataset. Exit status 1 where
more than 2 % of the outcomes, verdict and reason, are not reproduced with the study's own minimum. Needs numpy and the
program, which $GONOGO_PROGRAM or --gonogo names.
"""
import argparse
import csv
import io
import json
import os
import re
import subprocess
import sys
import tarfile
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy

MOST_DIFFERING = 0.02  # share of outcomes not reproduced with the study's own minimum
SLIP_WINDOW = 0.25     # of a course's slip [s] (pipeline/campaign/trial/watch.cpp)
UNSEEN = ("rollover", "slope_unstable", "simulation_failed")  # reasons that a course does not show
# Where a study does not say (pipeline/campaign/setup/setup.h).
THRESHOLDS = {"go_speed_share": 0.6, "go_slip": 0.4, "immobile_speed_m_per_s": 0.05, "immobile_s": 1, "slid_back_vehicle_lengths": 0.5}
SLACK = 1e-6  # of the clock of a course, written to 0.1 ms [s]
ROUNDING = 1e-4  # of a place between two lines of a course, written to 0.01 mm [m]


@dataclass
class Drive:
    """A course from the moment the driving begins, and the outcome that the dataset has."""
    time: numpy.ndarray     # [s]
    x: numpy.ndarray        # [m]
    rolled: numpy.ndarray   # by the driven wheels, mean [m]
    sinkage: numpy.ndarray  # [m]
    residual: float         # mean [m/s]
    speed: float            # commanded [m/s]
    known: dict


@dataclass
class Outcome:
    verdict: str
    reason: str
    time: float
    slip: float = float("nan")

    @property
    def passed(self):
        return self.verdict in ("go", "slow_go")


def table_of(gonogo, dataset):
    """The study's section `trial`, and the trials."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "table.json"
        subprocess.run([gonogo, "dataset", "export", dataset, "--format", "json", "--out", out], check=True,
                       stdout=subprocess.DEVNULL)
        table = json.loads(out.read_text())
    trial = table["provenance"]["study"]["trial"]
    if trial.get("task", {}).get("type", "climb") != "climb":
        raise SystemExit(f"{dataset}: its trials have a task with rules of its own; only climbs are judged here")
    return trial, table["trials"]


def course_texts(source):
    """Text of every course by the trial's number, from a folder or a packed campaign."""
    if source.is_dir():
        return {int(file.stem): file.read_text() for file in source.glob("*.csv") if file.stem.isdigit()}
    with tarfile.open(source) as archive:
        found = ((re.search(r"(?:^|/)courses/(\d+)\.csv$", member.name), member) for member in archive)
        return {int(name[1]): archive.extractfile(member).read().decode() for name, member in found if name}


def rolled_way(time, x, slip):
    """Way that the driven wheels rolled [m]: a course has the slip of its latest quarter second."""
    rolled = numpy.zeros(len(time))
    for k in range(1, len(time)):
        then, latest = max(time[k] - SLIP_WINDOW, 0), time[k - 1]
        back = numpy.interp([then, then - (time[k] - latest)], time[:k], rolled[:k])
        moved = x[k] - numpy.interp(then, time[:k], x[:k])
        if slip[k] == 0:  # rolls freely, or hardly turns, which is written as 0, too
            new = max(moved, 0)
        elif abs(1 - slip[k]) > 1e-4:
            new = moved / (1 - slip[k])
        else:  # spins on the spot, so that slip tells no way: as it went on before
            new = rolled[k - 1] - back[1]
        rolled[k] = back[0] + new
    return rolled


def drive_of(text, park, known):
    rows = list(csv.DictReader(io.StringIO(text)))
    column = {name: numpy.array([0.0] + [float(row[name]) for row in rows])
              for name in ("time_s", "x_m", "slip", "sinkage_m", "residual_m_per_s")}
    time, x = column["time_s"], column["x_m"]
    driven = time > park - SLACK
    if not driven.any():
        return Drive(*(numpy.zeros(0),) * 4, float("nan"), 0, known)
    rolled = rolled_way(time, x, column["slip"])
    residual = column["residual_m_per_s"][time > park + SLACK].mean()
    return Drive(time[driven] - park, x[driven], rolled[driven], column["sinkage_m"][driven], residual,
                 known["commanded_speed"], known)


class Judge:
    """The rules that end a drive and name its outcome, in their order (docs/trials.md, sim/state/monitor.h)."""

    def __init__(self, trial, vehicle, minimum):
        self.drive, self.limits = trial["drive"], {**THRESHOLDS, **trial.get("thresholds", {})}
        self.way = self.drive["run_in_m"] + self.drive["test_distance_m"]
        self.back = self.limits["slid_back_vehicle_lengths"] * vehicle["length_m"]
        self.clearance = vehicle["clearance_m"]
        self.earliest = self.drive["ramp_s"] + minimum

    def outcome(self, drive):
        for k, time in enumerate(drive.time):
            if drive.x[k] < -self.back:
                return Outcome("no_go", "slid_back", time)
            if time > self.earliest - SLACK and drive.x[k] >= self.way:
                return self.passing(drive, time)
            if self.immobile(drive, time):
                return Outcome("no_go", self.why_immobile(drive, time), time)
            if time > self.drive["time_limit_s"] - SLACK:
                return Outcome("no_go", "timeout", time)
        if drive.known["reason"] in UNSEEN:
            return Outcome(drive.known["verdict"], drive.known["reason"], drive.known["drive_time"] or 0)
        return Outcome("unknown", "simulation_failed", drive.time[-1] if len(drive.time) else 0)  # no rule ended it

    @staticmethod
    def since(drive, of, then, time):
        return numpy.interp(time, drive.time, of) - numpy.interp(then, drive.time, of)

    def passing(self, drive, time):
        half = time / 2
        moved = self.since(drive, drive.x, half, time)
        slip = 1 - moved / self.since(drive, drive.rolled, half, time)
        fast = moved / (time - half) >= self.limits["go_speed_share"] * drive.speed and slip <= self.limits["go_slip"]
        return Outcome("go" if fast else "slow_go", "none", time, slip)

    def immobile(self, drive, time):
        window = self.limits["immobile_s"]
        if time < max(self.earliest, self.drive["ramp_s"] + window) - SLACK:
            return False
        least = self.limits["immobile_speed_m_per_s"] * window
        return self.since(drive, drive.x, time - window, time) < least + ROUNDING

    def why_immobile(self, drive, time):
        window = self.limits["immobile_s"]
        if self.since(drive, drive.rolled, time - window, time) <= 0.5 * drive.speed * window:
            return "power"
        sunk = drive.sinkage[(drive.time > time / 2 + SLACK) & (drive.time <= time + SLACK)].mean()
        return "sinkage" if sunk > self.clearance else "traction"


def known_outcome(trial):
    return Outcome(trial["verdict"], trial["reason"], 0, trial["slip"])


def line(minimum, drives, outcomes):
    known = [known_outcome(d.known) for d in drives]
    pairs = list(zip(known, outcomes))
    stuck = [(a, b) for a, b in pairs if a.verdict == b.verdict == "no_go"]
    change = numpy.array([b.slip - a.slip for a, b in pairs if a.passed and b.passed])
    return (f"| {minimum:g} | {numpy.mean([b.time for b in outcomes]):.2f} "
            f"| {sum(a.passed != b.passed for a, b in pairs)} "
            f"| {sum(a.passed and b.passed and a.verdict != b.verdict for a, b in pairs)} "
            f"| {sum(a.reason != b.reason for a, b in stuck)} of {len(stuck)} "
            f"| {change.mean():+.4f} +- {change.std() / len(change) ** 0.5:.4f} | {(change ** 2).mean() ** 0.5:.4f} |")


def point_of(trial, names):
    return tuple(round(trial[name], 9) for name in names)


def against(minimum, drives, outcomes, others):
    """Holds outcomes against those of other trials of the same points."""
    names = ("slope_along", "slope_across", "friction_angle", "cohesion", "relative_density", "payload", "tyre_friction",
             "bed_depth", "commanded_speed")
    said = {point_of(d.known, names): (d.known["index"], o) for d, o in zip(drives, outcomes)}
    pairs = [(*said[point_of(t, names)], known_outcome(t)) for t in others if point_of(t, names) in said]
    print(f"\n{len(pairs)} of {len(others)} other trials have points of these, which are judged with a minimum of {minimum:g} s:")
    for index, outcome, other in pairs:
        if outcome.verdict != other.verdict:
            print(f"  trial {index}: {outcome.verdict} with a slip of {outcome.slip:.3f}, "
                  f"the other {other.verdict} ({other.reason}) with {other.slip:.3f}")
    change = numpy.array([other.slip - outcome.slip for _, outcome, other in pairs if outcome.passed and other.passed])
    print(f"  slip where both pass, {len(change)} trials, other minus this: mean {change.mean():+.4f}, "
          f"median {numpy.median(change):+.4f}, rms {(change ** 2).mean() ** 0.5:.4f}, largest {change[abs(change).argmax()]:+.4f}")


def not_reproduced(drives, outcomes):
    """Trials whose verdict or reason differs from the dataset's; says how many."""
    verdict = [d.known["index"] for d, said in zip(drives, outcomes) if said.verdict != d.known["verdict"]]
    reason = [d.known["index"] for d, said in zip(drives, outcomes) if said.reason != d.known["reason"]]
    wrong = sorted({*verdict, *reason})
    print(f"\nnot reproduced with the study's own minimum: verdict of {len(verdict)}, verdict or reason of {len(wrong)} of "
          f"{len(drives)} trials" + (f": {', '.join(map(str, wrong))}" if wrong else ""))
    return wrong


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dataset", type=Path)
    parser.add_argument("courses", type=Path, help="folder of courses, or the campaign.tar.gz that has them")
    parser.add_argument("--vehicle", type=Path, default=Path("configs/vehicles/hmmwv.json"), help="the trials' vehicle: length, clearance")
    parser.add_argument("--minimum", type=float, nargs="+", default=[2.5, 2, 1.5, 1], help="minimum_drive_s in place of the study's [s]")
    parser.add_argument("--against", type=Path, help="dataset of other trials of the same points, driven with the first --minimum")
    parser.add_argument("--gonogo", default=os.environ.get("GONOGO_PROGRAM", "build/cpu-release/gonogo"))
    return parser.parse_args()


def main():
    options = arguments()
    trial, trials = table_of(options.gonogo, options.dataset)
    vehicle = json.loads(options.vehicle.read_text())["chassis"]
    texts = course_texts(options.courses)
    drives = [drive_of(texts[t["index"]], trial["drive"]["park_s"], t) for t in trials if t["index"] in texts]
    own = trial["drive"]["minimum_drive_s"]
    if not drives or max(options.minimum) > own:
        raise SystemExit(f"needs courses of the dataset's trials, and minima up to the study's {own:g} s, where courses end")
    print(f"{len(trials)} trials, {len(drives)} with a course\n\n| minimum_drive_s | mean time driven [s] | pass or fail differs "
          "| go and slow-go differ | reason of a no-go differs | change in slip, mean | rms |\n|---|---|---|---|---|---|---|")
    outcomes = {m: [Judge(trial, vehicle, m).outcome(d) for d in drives] for m in [own, *options.minimum]}
    for minimum, said in outcomes.items():
        print(line(minimum, drives, said))
    wrong = not_reproduced(drives, outcomes[own])
    residual = numpy.array([d.residual for d in drives if len(d.time)])
    print(f"residual of the contacts while driving: rms over trials {1e3 * (residual ** 2).mean() ** 0.5:.1f} mm/s, "
          f"of the worst trial {1e3 * residual.max():.1f} mm/s")
    if options.against:
        against(options.minimum[0], drives, outcomes[options.minimum[0]], table_of(options.gonogo, options.against)[1])
    return 0 if len(wrong) <= MOST_DIFFERING * len(drives) else 1


if __name__ == "__main__":
    sys.exit(main())
