"""Our samplers as dimod samplers: sampler.sample(bqm), sample_ising(h, J), sample_qubo(Q).

All are pure functions of problem, parameters and seed. Conventions are those of Ocean: num_reads=None is 1 row, and
without a seed every call draws a new one; info["seed"] tells it. Rows of block Gibbs, tempering and population follow
exp(-energy) at beta_end = 1. The annealer's betas are fitted to the problem unless they are given.
"""
import inspect
import operator
import secrets
from typing import Any

import dimod
import numpy as np

from . import _core


class _LibrarySampler(dimod.Sampler):
    """A sampler of the library. Options are those of its constructor."""

    _name = ""

    def __init__(self, **options: Any) -> None:
        self._choice = _core.SamplerChoice(self._name, options)
        self._options = options

    @property
    def parameters(self) -> dict[str, list[str]]:
        return {"num_reads": [], "num_sweeps": [], "seed": []}

    @property
    def properties(self) -> dict[str, Any]:
        return {"name": self._name, **self._options}

    def sample(self, bqm: dimod.BinaryQuadraticModel, num_reads: int | None = None, num_sweeps: int | None = None,
               seed: int | None = None, **parameters: Any) -> dimod.SampleSet:
        """Draws num_reads rows (1), each after num_sweeps sweeps (1,000)."""
        self.remove_unknown_kwargs(**parameters)
        reads = _count("num_reads", num_reads, 1)
        sweeps = _count("num_sweeps", num_sweeps, 1000)
        start = secrets.randbits(32) if seed is None else _count("seed", seed, 0)
        if not reads or not bqm.num_variables:
            rows = np.empty((reads, bqm.num_variables), dtype=np.int8)
            return dimod.SampleSet.from_samples_bqm((rows, list(bqm.variables)), bqm, info={"seed": start})
        values, energies, counts, info = self._draw(bqm, reads, sweeps, start)
        return dimod.SampleSet.from_samples((values, list(bqm.variables)), energy=energies, num_occurrences=counts,
                                            vartype=bqm.vartype, info={**info, "seed": start})

    def _labels(self, bqm: dimod.BinaryQuadraticModel) -> list[int]:
        return list(range(bqm.num_variables))

    def _draw(self, bqm: dimod.BinaryQuadraticModel, reads: int, sweeps: int, seed: int) -> tuple[Any, Any, Any, Any]:
        problem = _problem(bqm, self._labels(bqm))
        return _core.sample(problem, self._choice, reads, seed, sweeps)


def _count(name: str, value: int | None, default: int) -> int:
    if value is None:
        return default
    count = operator.index(value)
    if count < 0:
        raise ValueError(f"{name} must not be negative, found {count}")
    return count


def _problem(bqm: dimod.BinaryQuadraticModel, labels: list[int]) -> _core.Problem:
    vectors = bqm.to_numpy_vectors(variable_order=list(bqm.variables), sort_indices=True)
    linear = np.asarray(vectors.linear_biases, dtype=np.float64)
    first, second, coupling = vectors.quadratic
    first, second = np.minimum(first, second), np.maximum(first, second)
    order = np.lexsort((second, first))
    return _core.Problem(bqm.vartype.name, labels, linear, np.ascontiguousarray(first[order], dtype=np.uint32),
                         np.ascontiguousarray(second[order], dtype=np.uint32),
                         np.ascontiguousarray(coupling[order], dtype=np.float64), float(vectors.offset))


def _sampler_class(name: str, title: str, about: str, parameters: list[tuple[str, Any, str]]) -> type[_LibrarySampler]:
    kind = inspect.Parameter.POSITIONAL_OR_KEYWORD
    signature = inspect.Signature([inspect.Parameter("self", kind)] + [
        inspect.Parameter(parameter, kind, default=value, annotation=type(value)) for parameter, value, _ in parameters])

    def __init__(*args: Any, **options: Any) -> None:
        given = signature.bind(*args, **options)
        given.apply_defaults()
        _LibrarySampler.__init__(**given.arguments)

    __init__.__signature__ = signature  # type: ignore[attr-defined]
    lines = [about, "", *(f"{parameter}: {text}" for parameter, _, text in parameters)]
    return type(title, (_LibrarySampler,), {"__doc__": "\n".join(lines).strip(), "__module__": __name__, "_name": name,
                                            "__init__": __init__})


# BlockGibbs, Annealer, Tempering, ...: the library's samplers, whose parameters have its names and defaults.
globals().update({title: _sampler_class(name, title, about, parameters)
                  for name, title, about, parameters in _core.samplers()})


def __getattr__(name: str) -> type[_LibrarySampler]:  # tells type checkers of these classes
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


class _EmulatedSampler(_LibrarySampler):
    """The rows of `gonogo qubo sample --sampler emulator`."""

    _name = "emulator"
    _as_programmed = False

    def __init__(self, graph: str = "chimera:12", dead_share: float = 0.0, dead_seed: int = 1,
                 temperature: float = 0.2) -> None:
        self._options = {"graph": graph, "dead_share": dead_share, "dead_seed": dead_seed, "temperature": temperature}
        self._device = _core.Device(graph, dead_share, dead_seed, temperature, self._as_programmed)

    def _draw(self, bqm: dimod.BinaryQuadraticModel, reads: int, sweeps: int, seed: int) -> tuple[Any, Any, Any, Any]:
        return _core.sample_emulated(_problem(bqm, self._labels(bqm)), self._device, reads, seed, sweeps)


class Emulator(_EmulatedSampler):
    """An emulated D-Wave 2X for any problem: embedded, and corrected so that rows follow exp(-energy).

    graph: "chimera:12", "pegasus:6", "zephyr:4", ... dead_share: share of dead qubits, drawn from dead_seed. temperature:
    of the machine, in units of the fields h.
    """


class Corrected(_LibrarySampler):
    """A machine on qubits, for any problem: embedded, and corrected as the emulator so that rows follow exp(-energy).

    machine: a dimod sampler of problems on the qubits of the graph, such as DWaveSampler(); parameters go to its sample().
    Its temperature need not be known. graph: "pegasus:16", "zephyr:15", ..., or solver: a definition file of SAPI with the
    working graph and ranges. temperature: where the search for the scale begins, in units of the fields h.
    """

    _name = "machine"

    def __init__(self, machine: dimod.Sampler, graph: str = "chimera:12", dead_share: float = 0.0, dead_seed: int = 1,
                 temperature: float = 0.2, solver: str = "", **parameters: Any) -> None:
        self._machine, self._parameters = machine, parameters
        self._options = {"graph": graph, "dead_share": dead_share, "dead_seed": dead_seed, "temperature": temperature,
                         "solver": solver}
        self._device = _core.Device(graph, dead_share, dead_seed, temperature, False, solver)

    def _draw(self, bqm: dimod.BinaryQuadraticModel, reads: int, sweeps: int, seed: int) -> tuple[Any, Any, Any, Any]:
        return _core.sample_corrected(_problem(bqm, self._labels(bqm)), self._device, self._spins, reads, seed, sweeps)

    def _spins(self, labels: list[int], linear: Any, first: Any, second: Any, coupling: Any, offset: float, reads: int,
               seed: int) -> Any:
        """Rows of the machine [reads, qubit]."""
        bqm = dimod.BinaryQuadraticModel.from_numpy_vectors(linear, (first, second, coupling), offset, "SPIN",
                                                            variable_order=labels)
        seeded = {"seed": seed % 2**31} if "seed" in self._machine.parameters else {}
        rows: Any = self._machine.sample(bqm, num_reads=reads, **{**seeded, **self._parameters})
        spins = rows.samples(sorted_by=None)[:, labels]
        return np.ascontiguousarray(np.repeat(spins, rows.record.num_occurrences, axis=0), dtype=np.int8)


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
    def sample(self, bqm: dimod.BinaryQuadraticModel, num_reads: int | None = None, num_sweeps: int | None = None,
               seed: int | None = None, **parameters: Any) -> dimod.SampleSet:
        """Programs the machine once and reads num_reads rows."""
        return super().sample(bqm, num_reads, num_sweeps, seed, **parameters)

    def _labels(self, bqm: dimod.BinaryQuadraticModel) -> list[int]:
        return list(bqm.variables)
