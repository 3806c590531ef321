"""Training and evaluation of models."""
import json
import os
from collections.abc import Mapping, Sequence
from typing import Any

from . import _core
from ._files import PathLike, study_file
from ._model import Model


def _with_torch() -> Any:
    try:
        from . import _train
    except ImportError as error:
        raise _core.InputError("training needs LibTorch, which this build of gonogo was made without; build it with: "
                               "pip install . -C cmake.define.GONOGO_TORCH=ON") from error
    return _train


def _family_name(family: PathLike | bool) -> str | None:
    if isinstance(family, bool):
        return "" if family else None
    return os.fspath(family)


def train(dataset: PathLike | Sequence[PathLike], out: PathLike, *, study: PathLike | None = None, learning: Mapping[str, Any] | None = None,
          seed: int | None = None, hold_out: int = 0, family: PathLike | bool = False, vehicles: Sequence[PathLike] = ()) -> Model:
    """Trains a model on a dataset and writes it to `out`, byte for byte as `gonogo train` does.

    dataset: or several; the model answers at the finest fidelity of them, and the others help.
    study: file or shipped name whose sections "learning" and "design" count. learning: that section, as a dict; it wins
    over the study's. seed: the study's, or 1. hold_out: number of trials kept back for evaluate().
    family: starts from the forecast of the model of the vehicle's family, which the trials correct: True for the one that
    ships, or its file or name.
    vehicles: datasets of vehicles of the family that `dataset` drove, each driven by itself: they shift its odds of passing.
    """
    datasets = [dataset] if isinstance(dataset, (str, os.PathLike)) else list(dataset)
    if not datasets:
        raise ValueError("dataset: there is none to train on")
    _with_torch().train([os.fspath(d) for d in datasets], os.fspath(out), study_file(study) if study is not None else "",
                        json.dumps(learning) if learning is not None else "", seed, hold_out, _family_name(family),
                        [os.fspath(v) for v in vehicles])
    return Model(out)


def evaluate(model: Model | PathLike, dataset: PathLike) -> dict[str, Any]:
    """Scores a model on the trials that it was not trained on: the report of `gonogo evaluate --json`."""
    file = os.fspath(model.path if isinstance(model, Model) else model)
    report: dict[str, Any] = _with_torch().evaluate(file, os.fspath(dataset))
    return report
