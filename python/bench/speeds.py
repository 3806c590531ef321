#!/usr/bin/env python3
"""Measures what docs/python.md promises of speed, and fails when a figure misses its bar.

    PYTHONPATH=build/cpu-release/python python python/bench/speeds.py build/cpu-release/python/predict_speed

The argument is the C++ program that predict() is compared with. Times are processor time of the shortest of five runs, so
that other load does not count, but for frames of trials, where two threads wait for each other.
"""
import pathlib
import subprocess
import sys
import tempfile
import time
import timeit
from collections.abc import Callable

ROWS, REPEATS = 1_000_000, 5
FAILED = []


def show(what: str, value: float, unit: str, bar: float, more_is_better: bool = False) -> None:
    holds = value >= bar if more_is_better else value < bar
    if not holds:
        FAILED.append(what)
    print(f"{what:58} {value:10.3g} {unit:8} {'at least' if more_is_better else 'below'} {bar:g} {unit}: "
          f"{'holds' if holds else 'MISSED'}", flush=True)


def import_time() -> float:
    """Shortest time of `import gonogo` in a fresh interpreter, with numpy and without the interpreter's own start [s]."""
    code = "import time; start = time.process_time(); import gonogo; print(time.process_time() - start)"
    return min(float(subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout)
               for _ in range(REPEATS))


def predict_share(program: str) -> float:
    """Speed of Model.predict over that of the C++ call, on the same points and one thread, measured in turn."""
    import numpy as np

    import gonogo

    gonogo.set_threads(1)
    model = gonogo.Model("hmmwv")
    low, high = np.array([model.sampled_ranges[v.name] for v in gonogo.variables()]).T
    points = low + (high - low) * np.random.default_rng(1).random((ROWS, len(low)))
    python, cpp = [], []
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "points.f64"
        points.tofile(file)
        for _ in range(REPEATS):
            python.append(timeit.timeit(lambda: model.predict(points), timer=time.process_time, number=1))
            out = subprocess.run([program, str(model.path), str(file), "1"], check=True, capture_output=True, text=True,
                                 env={"OMP_NUM_THREADS": "1"}).stdout.split()
            cpp.append(float(out[0]))
    total = float(np.sum(model.predict(points)))
    if abs(total - float(out[1])) > 1e-9 * total:
        raise SystemExit(f"the two sums of P(go) differ: {total} and {out[1]}")
    print(f"predict of {ROWS} rows: {min(python):.3f} s from Python, {min(cpp):.3f} s from C++")
    return min(cpp) / min(python)


def step_overhead() -> float:
    """Time of a step of a world that holds nothing, whose simulation costs next to nothing [us]."""
    import gonogo

    world = gonogo.World((1, 1, 1))
    world.add_floor(0.0)
    simulation = gonogo.Simulation([world])
    count = 100_000
    one_by_one = min(timeit.repeat(simulation.step, timer=time.process_time, number=count, repeat=REPEATS))
    together = min(timeit.repeat(lambda: simulation.step(count), timer=time.process_time, number=1, repeat=REPEATS))
    return (one_by_one - together) / count * 1e6


class Instant:
    """A trial of the library that takes no time: calls for `count` frames at once."""

    def __init__(self, count: int) -> None:
        self.count = count

    def run(self, on_frame: Callable[[object], None], *_: object) -> None:
        for _number in range(self.count):
            on_frame(self)


def frame_overhead() -> float:
    """Time that frames() of a trial takes to hand one frame to the loop's body and to go on [us]."""
    import gonogo

    count = 20_000

    def loop() -> None:
        trial = gonogo.Trial("hmmwv_quarter")
        trial._trial = Instant(count)
        assert sum(1 for _ in trial.frames(every=1.0)) == count

    return min(timeit.repeat(loop, number=1, repeat=REPEATS)) / count * 1e6


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit("speeds.py: give the program predict_speed of a build with tests, as in the first lines of this file")
    show("import gonogo, with numpy", import_time(), "s", 0.3)
    show("overhead of one Simulation.step()", step_overhead(), "us", 20)
    show("overhead of one frame of Trial.frames()", frame_overhead(), "us", 20)
    show("speed of predict() over that of C++", predict_share(sys.argv[1]), "", 0.8, more_is_better=True)
    if FAILED:
        raise SystemExit("missed: " + ", ".join(FAILED))
