"""Campaigns: all trials of a study, in worker processes."""
import os
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._dataset import Dataset
from ._files import PathLike, study_file


class Campaign:
    """All trials of a study in one folder. An interrupted campaign continues; the dataset's bytes stay the same."""

    def __init__(self, study: PathLike, folder: PathLike) -> None:
        """A study's path or shipped name, and the folder of the campaign."""
        self.study = study_file(study)
        self.folder = Path(folder)

    def design(self) -> NDArray[np.float64]:
        """Points of the design [trial_count, variable_count], in the units of the contract."""
        return _core.design(self.study)

    def run(self, *, workers: int | None = None, places: int | None = None, device: str | None = None,
            trials_per_shard: int = 256, progress: Callable[[int, int], object] | None = None,
            progress_interval: float = 1.0, gpus: int | None = None) -> Dataset:
        """Computes the missing trials and returns the dataset.

        workers: processes; None: as the study says, or one per core. places: trials side by side in a worker. device:
        "cpu" or "cuda". gpus: GPUs that the workers share, which means "cuda"; None: all. progress(done, trials) is called about every `progress_interval` seconds and at the end. Ctrl-C
        keeps what was finished.
        """
        command = [sys.executable, "-m", "gonogo.worker"]
        over = threading.Event()
        watcher = threading.Thread(target=self._watch, args=(over, progress, progress_interval), daemon=True)
        if progress is not None:
            watcher.start()
        try:
            summary = _core.run_campaign(self.study, os.fspath(self.folder), command, workers, places, device, trials_per_shard,
                                         gpus)
        finally:
            over.set()
            if progress is not None:
                watcher.join()
        if progress is not None:
            progress(summary["trials"], summary["trials"])
        return Dataset(summary["dataset"])

    def status(self) -> dict[str, Any]:
        """Trials, done trials, speed, counts; also while the campaign runs, in this process or another."""
        return _core.campaign_status(os.fspath(self.folder))

    def _watch(self, over: threading.Event, progress: Callable[[int, int], object] | None, interval: float) -> None:
        while not over.wait(interval):
            try:
                status = self.status()
            except _core.InputError:  # the folder is not claimed yet
                continue
            if progress is not None:
                progress(status["done"], status["trials"])
