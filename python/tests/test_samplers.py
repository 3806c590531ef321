import unittest

import dimod
import dimod.testing
import numpy as np
import pytest

import gonogo
from gonogo import samplers

SAMPLERS = [samplers.BlockGibbs, samplers.Annealer, samplers.Tempering, samplers.Population, samplers.Exact, samplers.Tabu,
            samplers.Emulator]


# dimod's own suite. One case per sampler, collected by pytest.
def conformance(sampler):
    return dimod.testing.load_sampler_bqm_tests(sampler)(type(f"Test{sampler.__name__}", (unittest.TestCase,), {}))


TestBlockGibbs, TestAnnealer, TestTempering, TestPopulation, TestExact, TestTabu, TestEmulator = map(conformance, SAMPLERS)


@pytest.mark.parametrize("sampler", [*SAMPLERS, samplers.StructuredEmulator])
def test_api(sampler):
    dimod.testing.assert_sampler_api(sampler())


def test_structure():
    emulator = samplers.StructuredEmulator(dead_share=0.02)
    dimod.testing.assert_structured_api(emulator)
    assert len(emulator.nodelist) == 1129  # of 1152
    a, b = emulator.edgelist[0]
    rows = emulator.sample_ising({a: 0.5}, {(a, b): -1.0}, num_reads=200, seed=2)
    assert rows.first.sample == {a: -1, b: -1}
    with pytest.raises(dimod.exceptions.BinaryQuadraticModelStructureError):
        emulator.sample_ising({}, {(0, 1): 1.0})


@pytest.mark.parametrize("sampler", [samplers.BlockGibbs, samplers.Tempering, samplers.Population, samplers.Exact])
def test_rows_follow_the_boltzmann_distribution(sampler):
    bqm = dimod.BinaryQuadraticModel({"a": 0.4, "b": -0.7, "c": 0.2}, {"ab": -0.9, "bc": 0.6}, 0.3, "SPIN")
    exact = dimod.ExactSolver().sample(bqm)
    weight = np.exp(-exact.record.energy)
    mean = (weight / weight.sum()) @ exact.samples(sorted_by=None)[:, ["a", "b", "c"]]
    reads = 8000
    rows = sampler().sample(bqm, num_reads=reads, num_sweeps=60, seed=5)
    assert rows.record.num_occurrences.sum() == reads
    found = np.average(rows.samples(sorted_by=None)[:, ["a", "b", "c"]], axis=0, weights=rows.record.num_occurrences)
    assert found == pytest.approx(mean, abs=4 / np.sqrt(reads))


def test_same_seed_same_rows():
    bqm = dimod.generators.gnp_random_bqm(20, 0.3, "SPIN", random_state=3)
    one, two, other = (samplers.Tempering().sample(bqm, num_reads=20, num_sweeps=50, seed=s) for s in (7, 7, 8))
    assert np.array_equal(one.record.sample, two.record.sample)
    assert not np.array_equal(one.record.sample, other.record.sample)


@pytest.mark.parametrize("sampler", [*SAMPLERS, samplers.StructuredEmulator])
def test_conventions_of_ocean(sampler):
    bqm = dimod.BinaryQuadraticModel.from_ising({0: 0.3, 96: -0.2}, {})  # qubits of a C12
    draw = (sampler(beta_end=1) if sampler is samplers.Annealer else sampler()).sample  # fitted betas find one row alone
    assert len(draw(bqm, num_reads=None, num_sweeps=None, seed=None)) == 1
    empty = draw(bqm, num_reads=0)
    assert len(empty) == 0 and list(empty.variables) == [0, 96]
    sweeps = 0 if sampler is samplers.Tabu else 60  # its moves find one row alone
    one, two = (draw(bqm, num_reads=64, num_sweeps=sweeps) for _ in range(2))
    assert one.info["seed"] != two.info["seed"]
    assert not np.array_equal(one.record.sample, two.record.sample)
    again = draw(bqm, num_reads=64, num_sweeps=sweeps, seed=one.info["seed"])
    assert np.array_equal(one.record.sample, again.record.sample)
    for wrong in ({"num_reads": -1}, {"seed": -1}):
        with pytest.raises(ValueError, match="must not be negative"):
            draw(bqm, **wrong)


def test_tabu_finds_the_ground_state_and_answers_no_model(model):
    bqm = dimod.generators.gnp_random_bqm(14, 0.5, "SPIN", random_state=2)
    rows = samplers.Tabu().sample(bqm, num_reads=5, num_sweeps=300, seed=1)
    assert rows.first.energy == pytest.approx(dimod.ExactSolver().sample(bqm).first.energy)
    given = {"slope_along": 12}
    lowest = samplers.Tabu().sample(model.to_bqm(given, "SPIN"), num_reads=300, seed=1)
    with pytest.raises(gonogo.InputError, match="follow no distribution"):
        model.answer(lowest, given)


def test_annealer_fits_its_betas_and_says_them():
    bqm = dimod.generators.gnp_random_bqm(12, 0.5, "SPIN", random_state=2)
    lowest = dimod.ExactSolver().sample(bqm).first.energy
    for scale in (1e-6, 1.0, 1e6):
        scaled = bqm.copy()
        scaled.scale(scale)
        rows = samplers.Annealer().sample(scaled, num_reads=50, num_sweeps=200, seed=1)
        assert rows.first.energy == pytest.approx(scale * lowest)
        assert 0 < rows.info["beta_start"] < rows.info["beta_end"]


@pytest.mark.parametrize("graph, temperature", [("pegasus:3", 0.05), ("zephyr:2", 0.3)])
def test_corrected_machine_of_unknown_temperature(graph, temperature):
    bqm = dimod.BinaryQuadraticModel({"a": 0.4, "b": -0.7, "c": 0.2, "d": 0.1}, {"ac": -0.9, "bc": 0.6, "ad": 0.5, "bd": -0.8},
                                     0.3, "SPIN")
    exact = dimod.ExactSolver().sample(bqm)
    weight = np.exp(-exact.record.energy)
    mean = (weight / weight.sum()) @ exact.samples(sorted_by=None)[:, list("abcd")]

    class Machine(samplers.Annealer):  # tells nobody its temperature
        def sample(self, problem, **parameters):
            assert max(map(abs, problem.quadratic.values())) <= 1
            return super().sample(problem, **parameters)

    machine = Machine(beta_end=1 / temperature)
    rows = samplers.Corrected(machine, graph, num_sweeps=100).sample(bqm, num_reads=4000, seed=3)
    assert rows.info["correction"]["scale"] == pytest.approx(temperature, rel=0.3)
    assert rows.samples(sorted_by=None)[:, list("abcd")].mean(axis=0) == pytest.approx(mean, abs=0.06)
    assert np.array_equal(rows.record.sample,
                          samplers.Corrected(machine, graph, num_sweeps=100).sample(bqm, num_reads=4000, seed=3).record.sample)


def test_emulator_finds_the_ground_state_of_a_small_glass():
    bqm = dimod.generators.gnp_random_bqm(8, 0.6, "SPIN", random_state=1)
    lowest = dimod.ExactSolver().sample(bqm).first.energy
    assert samplers.Emulator().sample(bqm, num_reads=100, seed=1).first.energy == pytest.approx(lowest)


def test_a_model_goes_to_dimod_and_back(model):
    given = {"slope_along": 15.0}
    bqm = model.to_bqm(given, "SPIN")
    assert isinstance(bqm, dimod.BinaryQuadraticModel)
    rows = samplers.Tempering().sample(bqm, num_reads=300, num_sweeps=200, seed=4)
    answer = model.answer(rows, given, min_reads=10)
    assert answer.summary["energies"] == "verified"
    assert set(answer.columns["slope_along"]) == {15.0}
    frame = answer.to_pandas()
    assert set(frame["outcome"]) <= set(gonogo.outcomes())
    with pytest.raises(gonogo.InputError):
        model.answer(rows, {"slope_along": 16.0})


def test_a_sampler_that_cannot_says_so():
    triangle = dimod.BinaryQuadraticModel.from_ising({}, {"ab": 1, "bc": 1, "ca": 1})
    with pytest.raises(gonogo.InputError, match="bipartite"):
        samplers.BlockGibbs().sample(triangle)
