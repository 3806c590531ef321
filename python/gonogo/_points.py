"""Points of variables, from what people have them in: dict, pandas, numpy."""
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._contract import variables


class Points(NamedTuple):
    """values: [row, variable], NaN where unknown. index: of a pandas frame. one: a single point was given."""

    values: NDArray[np.float64]
    index: Any = None
    one: bool = False


def points_of(given: Any) -> Points:
    """A dict or frame with any subset of the variables, or an array [row, variable] of all of them in order."""
    if isinstance(given, Mapping):
        return _of_columns({name: _with_unknowns(column) for name, column in given.items()})
    if hasattr(given, "columns") and hasattr(given, "to_numpy"):
        return Points(_of_frame(given), given.index)
    array = np.ascontiguousarray(_with_unknowns(given))
    return Points(array[None, :], one=True) if array.ndim == 1 else Points(array)


def _with_unknowns(given: Any) -> NDArray[np.float64]:
    """As float64; what is masked is unknown."""
    if np.ma.isMaskedArray(given):
        return np.ma.filled(given.astype(np.float64), np.nan)
    return np.asarray(given, dtype=np.float64)


def _of_columns(columns: dict[str, NDArray[np.float64]]) -> Points:
    shape = np.broadcast_shapes((), *(column.shape for column in columns.values()))
    if len(shape) > 1:
        raise _core.InputError(f"points: a column has {len(shape)} dimensions, at most 1 is allowed")
    values = np.full((shape[0] if shape else 1, len(variables())), np.nan)
    for name, column in columns.items():
        values[:, _core.variable_index(name)] = column
    return Points(values, one=not shape)


def _of_frame(frame: Any) -> NDArray[np.float64]:
    if tuple(frame.columns) == tuple(v.name for v in variables()):
        return np.ascontiguousarray(frame.to_numpy(dtype=np.float64))
    values = np.full((len(frame), len(variables())), np.nan)
    for name in frame.columns:
        values[:, _core.variable_index(str(name))] = frame[name].to_numpy(dtype=np.float64)
    return values
