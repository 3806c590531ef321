import unittest

import dimod
import dimod.testing
import numpy as np
import pytest

import gonogo
from gonogo import samplers

SAMPLERS = [samplers.BlockGibbs, samplers.Annealer, samplers.Tempering, samplers.Population, samplers.Exact, samplers.Emulator]


# dimod's own suite. One case per sampler, collected by pytest.
def conformance(sampler):
    return dimod.testing.load_sampler_bqm_tests(sampler)(type(f"Test{sampler.__name__}", (unittest.TestCase,), {}))


TestBlockGibbs, TestAnnealer, TestTempering, TestPopulation, TestExact, TestEmulator = map(conformance, SAMPLERS)


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
