"""Our samplers as dimod samplers: sampler.sample(bqm), sample_ising(h, J), sample_qubo(Q).

All are pure functions of problem, parameters and seed. Rows of block Gibbs, tempering and population follow
exp(-energy) at beta_end = 1.
"""
import json
import tempfile
from pathlib import Path
from typing import Any

import dimod
import numpy as np

from . import _core


class _LibrarySampler(dimod.Sampler):
    """A sampler of the library. Options are those of its constructor."""

    _name = ""

    def __init__(self, **options: Any) -> None:
        self._choice = _core.SamplerChoice(self._name, **options)
        self._options = options

    @property
    def parameters(self) -> dict[str, list[str]]:
        return {"num_reads": [], "num_sweeps": [], "seed": []}

    @property
    def properties(self) -> dict[str, Any]:
        return {"name": self._name, **self._options}

    def sample(self, bqm: dimod.BinaryQuadraticModel, num_reads: int = 1, num_sweeps: int = 1000, seed: int = 0,
               **parameters: Any) -> dimod.SampleSet:
        """Draws num_reads rows, each after num_sweeps sweeps."""
        self.remove_unknown_kwargs(**parameters)
        if not bqm.num_variables:
            return dimod.SampleSet.from_samples_bqm(([[]] * num_reads, []), bqm)
        values, energies, counts, info = self._draw(bqm, num_reads, num_sweeps, seed)
        return dimod.SampleSet.from_samples((values, list(bqm.variables)), energy=energies, num_occurrences=counts,
                                            vartype=bqm.vartype, info=info)

    def _labels(self, bqm: dimod.BinaryQuadraticModel) -> list[int]:
        return list(range(bqm.num_variables))

    def _draw(self, bqm: dimod.BinaryQuadraticModel, reads: int, sweeps: int, seed: int) -> tuple[Any, Any, Any, Any]:
        problem = _problem(bqm, self._labels(bqm))
        values, energies, counts, info = _core.sample(problem, self._choice, reads, seed, sweeps)
        return values, energies, counts, json.loads(info)


def _problem(bqm: dimod.BinaryQuadraticModel, labels: list[int]) -> _core.Problem:
    vectors = bqm.to_numpy_vectors(variable_order=list(bqm.variables), sort_indices=True)
    linear = np.asarray(vectors.linear_biases, dtype=np.float64)
    first, second, coupling = vectors.quadratic
    first, second = np.minimum(first, second), np.maximum(first, second)
    order = np.lexsort((second, first))
    return _core.Problem(bqm.vartype.name, labels, linear, np.ascontiguousarray(first[order], dtype=np.uint32),
                         np.ascontiguousarray(second[order], dtype=np.uint32),
                         np.ascontiguousarray(coupling[order], dtype=np.float64), float(vectors.offset))


class BlockGibbs(_LibrarySampler):
    """Block Gibbs sampling of bipartite problems, such as those of models without clamped hidden units."""

    _name = "block_gibbs"

    def __init__(self, on_gpu: bool = False) -> None:
        super().__init__(on_gpu=on_gpu)


class Annealer(_LibrarySampler):
    """Simulated annealing from beta_start to beta_end [1 / energy]."""

    _name = "anneal"

    def __init__(self, beta_start: float = 0.1, beta_end: float = 1.0) -> None:
        super().__init__(beta_start=beta_start, beta_end=beta_end)


class Tempering(_LibrarySampler):
    """Parallel tempering over `replicas` temperatures between beta_start and beta_end [1 / energy]."""

    _name = "tempering"

    def __init__(self, beta_start: float = 0.1, beta_end: float = 1.0, replicas: int = 10) -> None:
        super().__init__(beta_start=beta_start, beta_end=beta_end, replicas=replicas)


class Population(_LibrarySampler):
    """Population annealing over `temperatures` steps from beta_start to beta_end [1 / energy]."""

    _name = "population"

    def __init__(self, beta_start: float = 0.1, beta_end: float = 1.0, temperatures: int = 30) -> None:
        super().__init__(beta_start=beta_start, beta_end=beta_end, temperatures=temperatures)


class Exact(_LibrarySampler):
    """Independent samples of small problems and of those of low treewidth."""

    _name = "exact"


class _EmulatedSampler(_LibrarySampler):
    """Samples problem files, as `gonogo qubo sample --sampler emulator` does."""

    _name = "emulator"
    _as_programmed = False

    def __init__(self, graph: str = "chimera:12", dead_share: float = 0.0, dead_seed: int = 1,
                 temperature: float = 0.2) -> None:
        self._options = {"graph": graph, "dead_share": dead_share, "dead_seed": dead_seed, "temperature": temperature}
        self._device = _core.Device(graph, dead_share, dead_seed, temperature, self._as_programmed)

    def _draw(self, bqm: dimod.BinaryQuadraticModel, reads: int, sweeps: int, seed: int) -> tuple[Any, Any, Any, Any]:
        labels = self._labels(bqm)
        plain = dimod.BinaryQuadraticModel(bqm, dtype=np.float64)
        plain.relabel_variables(dict(zip(list(bqm.variables), labels)))
        with tempfile.TemporaryDirectory() as name:
            problem, answer = Path(name) / "problem.json", Path(name) / "answer.json"
            problem.write_text(json.dumps(plain.to_serializable()))
            report = _core.sample_emulated(str(problem), str(answer), self._device, reads, seed, sweeps)
            rows = dimod.SampleSet.from_serializable(json.loads(answer.read_text()))
        columns = [rows.variables.index(label) for label in labels]
        return (rows.record.sample[:, columns], rows.record.energy, rows.record.num_occurrences, json.loads(report))


class Emulator(_EmulatedSampler):
    """An emulated D-Wave 2X for any problem: embedded, and corrected so that rows follow exp(-energy).

    graph: "chimera:12", "pegasus:6", "zephyr:4", ... dead_share: share of dead qubits, drawn from dead_seed. temperature:
    of the machine, in units of the fields h.
    """


class StructuredEmulator(_EmulatedSampler, dimod.Structured):
    """The same machine as its clients see it: labels are qubits, biases lie in its ranges, nothing is corrected."""

    _as_programmed = True

    def __init__(self, graph: str = "chimera:12", dead_share: float = 0.0, dead_seed: int = 1,
                 temperature: float = 0.2) -> None:
        super().__init__(graph, dead_share, dead_seed, temperature)
        qubits, couplers = _core.graph_of(self._device)
        self._nodelist, self._edgelist = list(qubits), [tuple(pair) for pair in couplers]

    @property
    def nodelist(self) -> list[int]:
        return self._nodelist

    @property
    def edgelist(self) -> list[tuple[int, int]]:
        return self._edgelist

    @dimod.bqm_structured
    def sample(self, bqm: dimod.BinaryQuadraticModel, num_reads: int = 1, num_sweeps: int = 1000, seed: int = 0,
               **parameters: Any) -> dimod.SampleSet:
        """Programs the machine once and reads num_reads rows."""
        return super().sample(bqm, num_reads, num_sweeps, seed, **parameters)

    def _labels(self, bqm: dimod.BinaryQuadraticModel) -> list[int]:
        return list(bqm.variables)
