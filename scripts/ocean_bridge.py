#!/usr/bin/env python3
r"""Samples an exported problem with a sampler of D-Wave's Ocean and writes the answer.

    gonogo qubo sample p.json --sampler command --reads 100 --out answer.json -- \
        python3 scripts/ocean_bridge.py {problem} {answer} --reads {reads} --seed {seed} --sampler annealer

problem: dimod's JSON or binary file; answer: dimod's SampleSet as JSON. Samplers: qpu (the machine that the user's D-Wave
configuration names; the problem must be on its qubits), annealer, tree, random, exact (dwave-samplers, dimod). Which one
sampled stands in the answer's info. Needs: pip install dimod dwave-samplers (and dwave-system for qpu).
"""
import argparse
import json
import os
import sys

try:
    import dimod
except ImportError:
    sys.exit("ocean_bridge.py: dimod is not installed; pip install dimod dwave-samplers")


def read_problem(path):
    with open(path, "rb") as file:
        content = file.read()
    if content.startswith(b"DIMODBQM"):
        return dimod.BinaryQuadraticModel.from_file(content)
    return dimod.BinaryQuadraticModel.from_serializable(json.loads(content))


def qpu():
    """The machine of the user's D-Wave configuration; every way of not getting it ends in one sentence."""
    try:
        from dwave.system import DWaveSampler
    except ImportError:
        sys.exit("ocean_bridge.py: dwave-system is not installed; pip install dwave-system")
    try:
        return DWaveSampler()
    except Exception as error:  # of the client, of the network, or ValueError for a missing token
        reason = str(error).strip().splitlines()
        sys.exit("ocean_bridge.py: no machine can be reached: %s; set an API token with dwave config create or "
                 "DWAVE_API_TOKEN" % (reason[0] if reason else type(error).__name__))


def sample(bqm, arguments):
    reads, seed = arguments.reads, arguments.seed % 2**31
    if arguments.sampler == "qpu":
        return qpu().sample(bqm, num_reads=reads, auto_scale=False, answer_mode="raw")  # scaling would change beta
    if arguments.sampler == "exact":
        sys.exit("ocean_bridge.py: the sampler exact lists all states and draws no rows; use tree")
    try:
        from dwave import samplers
    except ImportError:
        sys.exit("ocean_bridge.py: dwave-samplers is not installed; pip install dwave-samplers")
    if arguments.sampler == "annealer":  # heat bath in random order up to beta = 1: rows follow exp(-E)
        return samplers.SimulatedAnnealingSampler().sample(
            bqm, num_reads=reads, num_sweeps=arguments.sweeps, beta_range=[0.1, 1.0], seed=seed,
            proposal_acceptance_criteria="Gibbs", randomize_order=True)
    if arguments.sampler == "tree":
        return samplers.TreeDecompositionSampler().sample(bqm, num_reads=reads, beta=1.0, seed=seed)
    return samplers.RandomSampler().sample(bqm, num_reads=reads, seed=seed)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("problem")
    parser.add_argument("answer")
    parser.add_argument("--reads", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--sweeps", type=int, default=1000)
    parser.add_argument("--sampler", choices=["qpu", "annealer", "tree", "random"], required=True)
    arguments = parser.parse_args()
    try:
        bqm = read_problem(arguments.problem)
    except (OSError, ValueError, KeyError) as error:
        sys.exit("ocean_bridge.py: %s: cannot be read as a problem of dimod: %s" % (arguments.problem, error))
    found = sample(bqm, arguments)
    answer = dimod.SampleSet.from_samples_bqm((found.record.sample, found.variables), bqm.change_vartype(
        found.vartype, inplace=False), num_occurrences=found.record.num_occurrences)
    answer.info["ocean_sampler"] = arguments.sampler
    partial = arguments.answer + ".partial"
    with open(partial, "w") as file:
        json.dump(answer.to_serializable(), file)
    os.replace(partial, arguments.answer)
    return 0


if __name__ == "__main__":
    sys.exit(main())
