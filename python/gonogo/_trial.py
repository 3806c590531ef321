"""Single trials, run to their end or frame by frame."""
import threading
from collections.abc import Callable, Iterator

from . import _core
from ._files import PathLike, study_file


class _Left(Exception):
    """Nobody wants the next frame."""


class Trial:
    """One trial of a vehicle on a bed of grains.

    The trial is a pure function of its arguments: the same verdict, measures and bits as `gonogo simulate` gives.
    """

    def __init__(self, vehicle: PathLike | None = None, soil: str = "calibration_90mm", *, study: PathLike | None = None,
                 task: str = "", seed: int = 0, **values: float) -> None:
        """A vehicle and a calibration of grains by name or path, or a study; one of the two.

        task: type of trial with its numbers, such as "drawbar" or "step:height_m=0.2"; "" is a climb.
        values: variables in the units of the contract, such as slope_along=12. The others keep the usual values, or the
        study's fixed values and middles of ranges.
        """
        if (vehicle is None) == (study is None):
            raise _core.InputError("Trial: name a vehicle or a study; one of the two")
        if study is not None:
            self._trial = _core.Trial.of_study(study_file(study), values, seed)
        else:
            self._trial = _core.Trial.of_vehicle(str(vehicle), soil, task, values, seed)
        self.record: _core.TrialRecord | None = None

    @property
    def variables(self) -> dict[str, float]:
        """All variables of the trial, in the units of the contract."""
        values: dict[str, float] = self._trial.variables
        return values

    @property
    def step_size(self) -> float:
        """Time step of the first attempt [s]."""
        return self._trial.step_size

    def run(self, *, threads: int = 1, gpu: bool = False, progress: Callable[[float, float], object] | None = None,
            progress_interval: float = 0.1, gpus: int | None = None) -> _core.TrialRecord:
        """Runs the trial to its end.

        gpus: number of GPUs over which the world is divided, with the same bits; None: with gpu=True, as many as pay.
        progress(time, time limit) is called at intervals of simulated time [s].
        """
        limit = self._trial.time_limit
        show = None if progress is None else lambda frame: progress(frame.time, limit)
        self.record = self._trial.run(show, progress_interval, threads, gpu, gpus)
        return self.record

    def frames(self, every: float = 0.0, *, threads: int = 1, gpu: bool = False, gpus: int | None = None) -> Iterator[_core.Frame]:
        """Runs the trial frame by frame: at the start, every so many simulated seconds, and at the end.

        every = 0 gives every step. The trial waits while the loop's body runs. `record` is set after the last frame. A
        frame's bodies can be read until the next frame.
        """
        handed: list[_core.Frame | None] = []
        ready, go_on = threading.Lock(), threading.Lock()  # raw locks: a handshake of conditions takes three times as long
        ready.acquire()
        go_on.acquire()
        left = False
        failure: list[BaseException] = []

        def hand_over(frame: _core.Frame) -> None:
            handed.append(frame)
            ready.release()
            go_on.acquire()
            if left:
                raise _Left

        def run() -> None:
            try:
                self.record = self._trial.run(hand_over, every or self.step_size, threads, gpu, gpus)
            except _Left:
                pass
            except BaseException as error:  # to be raised by the loop
                failure.append(error)
            handed.append(None)
            ready.release()

        thread = threading.Thread(target=run, daemon=True)
        thread.start()
        ended = False
        try:
            while True:
                ready.acquire()
                frame = handed.pop()
                if frame is None:
                    ended = True
                    break
                yield frame
                go_on.release()
        finally:
            if not ended:
                left = True
                if go_on.locked():
                    go_on.release()
            thread.join()
        if failure:
            raise failure[0]
