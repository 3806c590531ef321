"""The contract: every variable, measure and outcome, as the library holds them."""
import functools
import json
from typing import Any, NamedTuple

from . import _core


class Variable(NamedTuple):
    """A variable of a trial. The model takes values from min to max, in the unit."""

    name: str
    label: str
    unit: str
    min: float
    max: float


class Measure(NamedTuple):
    """A number that a trial reports, in the unit."""

    name: str
    unit: str
    about: str


@functools.cache
def _contract() -> Any:
    return json.loads(_core.contract_text())


@functools.cache
def variables() -> tuple[Variable, ...]:
    """All variables, in the order of the columns of a point."""
    return tuple(Variable(v["name"], v["label"], v["unit"], *v["range"]) for v in _contract()["variables"])


@functools.cache
def measures() -> tuple[Measure, ...]:
    """All measures."""
    return tuple(Measure(m["name"], m["unit"], m["about"]) for m in _contract()["measures"])


@functools.cache
def outcomes() -> tuple[str, ...]:
    """All outcomes of a valid trial, in the order of the columns of predict_outcomes()."""
    return tuple(_core.outcome_names())


@functools.cache
def names(section: str) -> dict[int, str]:
    """Code -> name of the verdicts or reasons."""
    return {entry["code"]: entry["name"] for entry in _contract()[section]}
