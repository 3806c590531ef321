"""Trained models: predictions, reconstructions, annealing problems and their answers."""
import os
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._contract import outcomes, variables
from ._files import PathLike
from ._points import points_of

if TYPE_CHECKING:
    import dimod
    import pandas

class Answer(NamedTuple):
    """Decoded rows of an annealer or sampler.

    summary: reads, frequencies of outcomes with standard errors beside the machine's own probabilities, mean and spread of
    variables, bias of the sampler. columns: name -> array over the rows: every variable in its unit, "outcome", "energy",
    "occurrences", and "weight" when rows are weighed.
    """

    summary: dict[str, Any]
    columns: dict[str, NDArray[Any]]

    def to_pandas(self) -> "pandas.DataFrame":
        """The rows as a frame."""
        import pandas

        return pandas.DataFrame(self.columns)


def _answer(summary: dict[str, Any], columns: dict[str, list[Any]]) -> Answer:
    return Answer(summary, {name: np.asarray(column) for name, column in columns.items()})


class Model:
    """A trained model: P(outcome | variables) for any subset of the variables.

    Points are given as a dict or pandas frame of any subset of variables, or as an array [n, variable_count] in the
    order of gonogo.variables(). NaN is unknown. Unknown variables are summed out. Values outside a variable's range
    raise InputError. Bits are those of `gonogo infer`, for any number of threads.
    """

    def __init__(self, model: PathLike) -> None:
        """Reads a model: a file, a folder that holds model.h5, or the name of a shipped model or of its vehicle.

        Raises InputError for an unknown name, with the nearest ones, and for a file that is damaged or of another contract.
        """
        self.path = Path(_core.find_model(os.fspath(model)))
        self._predictor = _core.Predictor.read(os.fspath(self.path))

    def __repr__(self) -> str:
        return f"gonogo.Model({str(self.path)!r})"

    def predict(self, points: Any) -> Any:
        """P(go or slow_go | a valid trial): array [n], a Series for a frame, a float for one point."""
        given = points_of(points)
        p = self._predictor.p_go(given.values)
        if given.index is not None:
            import pandas

            return pandas.Series(p, index=given.index, name="p_go")
        return float(p[0]) if given.one else p

    def predict_outcomes(self, points: Any) -> Any:
        """P(outcome): array [n, outcome_count] in the order of gonogo.outcomes(), or a frame for a frame."""
        given = points_of(points)
        p = self._predictor.outcome_probabilities(given.values)
        if given.index is not None:
            import pandas

            return pandas.DataFrame(p, index=given.index, columns=list(outcomes()))
        return p

    def novelty(self, points: Any) -> NDArray[np.float64]:
        """Distance to the nearest trial over the usual one between trials [n]: 0 on a trial, large where none was."""
        return self._predictor.novelty(points_of(points).values)

    def inside_sampled_box(self, points: Any) -> NDArray[np.bool_]:
        """Whether all known variables lie in the ranges that trials sampled [n]."""
        return self._predictor.inside_sampled_box(points_of(points).values).astype(bool)

    def reconstruct(self, given: Mapping[str, float], outcome: str | None = None) -> dict[str, Any]:
        """Distribution of every unknown variable given the known ones, and the outcome if it is known.

        The answer is that of `gonogo infer --reconstruct --json`: "reconstruction" holds mean, deviation, low, high and
        all bins of each unknown variable, in its unit.
        """
        return self._predictor.answer(points_of(given).values, outcome, True)

    def infer(self, given: Mapping[str, float], outcome: str | None = None) -> dict[str, Any]:
        """The answer of `gonogo infer --json` to one point, with standard errors, novelty and what was summed out."""
        return self._predictor.answer(points_of(given).values, outcome, False)

    def to_bqm(self, given: Mapping[str, float] | None = None, vartype: str = "BINARY",
               code_penalty: float | None = None) -> "dimod.BinaryQuadraticModel":
        """The machine as an annealing problem whose Boltzmann distribution at beta = 1 is the model's.

        given: variables that are clamped to these values and leave the problem. code_penalty: energy added to bit
        patterns that are no code word; None: as `gonogo qubo export` does, free units stand for code words where these
        would be rare, and answer() gives code words by the hidden units.
        """
        import dimod

        labels, linear, first, second, coupling, offset = self._machine(given, vartype, code_penalty).coefficients()
        return dimod.BinaryQuadraticModel.from_numpy_vectors(linear, (first, second, coupling), offset,
                                                             dimod.Vartype[vartype], variable_order=labels)

    def answer(self, sampleset: "dimod.SampleSet", given: Mapping[str, float] | None = None,
               code_penalty: float | None = None, *, decoding: str = "weigh", min_reads: float = 100,
               min_share: float = 0.05) -> Answer:
        """Decodes the samples of to_bqm(given, vartype, code_penalty) into variables and outcomes.

        Labels and energies are checked, so other arguments than those of to_bqm() raise InputError. decoding: "weigh" lets
        the hidden units of every row weigh all code words; "discard" leaves out rows with a pattern that is no code word;
        "repair" maps them to the nearest value. The latter two need a code_penalty where free units stand for code words. Answers with fewer usable reads than the two limits are refused.
        """
        rows: Any = sampleset  # dimod's own annotations end here
        record, vartype = rows.record, rows.vartype.name
        labels = [label if isinstance(label, (int, str)) else str(label) for label in rows.variables]
        return _answer(*self._machine(given, vartype, code_penalty).decode(
            vartype, labels, np.ascontiguousarray(record.sample, dtype=np.int8),
            np.ascontiguousarray(record.energy, dtype=np.float64),
            np.ascontiguousarray(record.num_occurrences, dtype=np.int64), rows.info, decoding, min_reads, min_share))

    def sample(self, reads: int, given: Mapping[str, float] | None = None, *, sampler: str = "exact",
               sweeps: int = 1000, seed: int = 0, decoding: str = "weigh", code_penalty: float | None = None) -> Answer:
        """Rows of variables and outcomes, drawn from the machine given the known variables.

        sampler: "exact" enumerates machines of up to 22 hidden units; "block_gibbs", "tempering" and "population" draw
        from larger ones with Markov chains of `sweeps` sweeps. The same arguments give the same rows.
        """
        machine = self._machine(given, "BINARY", code_penalty)
        return _answer(*machine.sample(_core.SamplerChoice(sampler), reads, seed, sweeps, decoding))

    @property
    def sampled_ranges(self) -> dict[str, tuple[float, float]]:
        """Variable -> range in which trials were made, in its unit."""
        ends = zip(self._predictor.sampled_lower, self._predictor.sampled_upper)
        return {v.name: end for v, end in zip(variables(), ends)}

    @property
    def provenance(self) -> dict[str, Any]:
        """Settings, counts and scores of the training, and hashes of what it read."""
        return self._predictor.provenance

    def _machine(self, given: Mapping[str, float] | None, vartype: str, code_penalty: float | None) -> _core.MachineProblem:
        return _core.MachineProblem(self._predictor, dict(given or {}), vartype, code_penalty)
