"""CPU seconds of gonogo's annealer and of dwave-samplers' to rows of the same quality, on one core.

    annealer_speed.py <gonogo>      run by scripts/annealer_speed.sh inside a virtual environment

Both cool from the same beta to the same beta. dwave-samplers runs as its users run it (Metropolis, geometric schedule)
and by heat bath. Ours gets the fewest sweeps, of a list, whose mean energy is not above theirs plus its standard error;
its time is that of the whole program: start, file, annealing, answer. Theirs is the time inside sample().
"""
import json
import math
import os
import random
import resource
import subprocess
import sys
import tempfile
import time

import dimod
from dwave.samplers import SimulatedAnnealingSampler

READS, SWEEPS, SEED, BETAS, TARGET = 400, 1000, 3, (0.1, 5.0), 3.0


def chimera(side):
    """Edges of Chimera C(side) with four qubits a side of a cell: the graph of a D-Wave 2X for side 12."""
    def qubit(i, j, u, k):
        return ((i * side + j) * 2 + u) * 4 + k
    for i in range(side):
        for j in range(side):
            for k in range(4):
                yield from ((qubit(i, j, 0, k), qubit(i, j, 1, q)) for q in range(4))
                if i + 1 < side:
                    yield qubit(i, j, 0, k), qubit(i + 1, j, 0, k)
                if j + 1 < side:
                    yield qubit(i, j, 1, k), qubit(i, j + 1, 1, k)


def problems():
    random.seed(1)
    glass = dimod.BinaryQuadraticModel("SPIN")
    glass.add_linear_from((q, 0.0) for q in range(8 * 12 * 12))
    for a, b in chimera(12):
        glass.add_quadratic(a, b, random.gauss(0, 1))
    yield "C12, normal couplings, 1152 spins", glass
    machine = dimod.BinaryQuadraticModel("BINARY")
    machine.add_linear_from((i, random.gauss(0, 0.4)) for i in range(336))
    for i in range(168):
        for j in range(168, 336):
            machine.add_quadratic(i, j, random.gauss(0, 0.4))
    yield "Boltzmann machine, 168 x 168 units", machine


def mean(values):
    return sum(values) / len(values)


def error_of_mean(values):
    middle = mean(values)
    return math.sqrt(sum((x - middle) ** 2 for x in values)) / len(values)


def cpu_of_children():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def theirs(bqm, rule):
    start = time.process_time()
    found = SimulatedAnnealingSampler().sample(bqm, num_reads=READS, num_sweeps=SWEEPS, beta_range=BETAS, seed=SEED,
                                               proposal_acceptance_criteria=rule)
    return time.process_time() - start, [float(e) for e in found.record.energy]


def ours(gonogo, bqm, sweeps):
    with open("problem.json", "w") as file:
        json.dump(bqm.to_serializable(), file)
    start = cpu_of_children()
    subprocess.run([gonogo, "qubo", "sample", "problem.json", "--sampler", "anneal", "--schedule", "linear", "--beta-start", str(BETAS[0]),
                    "--beta", str(BETAS[1]), "--reads", str(READS), "--sweeps", str(sweeps), "--seed", str(SEED),
                    "--out", "answer.json"], check=True, stdout=subprocess.DEVNULL)
    used = cpu_of_children() - start
    with open("answer.json") as file:
        rows = dimod.SampleSet.from_serializable(json.load(file))
    energies = bqm.energies(rows)  # by dimod, not as the answer says
    return used, [float(e) for e in energies]


def main():
    gonogo = os.path.abspath(sys.argv[1])
    worst = math.inf
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for name, bqm in problems():
            for rule in ("Metropolis", "Gibbs"):
                seconds, energies = theirs(bqm, rule)
                for sweeps in (500, 600, 700, 850, 1000, 1200, 1400, 2000, 2800, 4000):
                    own_seconds, own = ours(gonogo, bqm, sweeps)
                    if mean(own) <= mean(energies) + error_of_mean(energies):
                        break
                else:
                    raise SystemExit("annealer_speed: %s: 4000 sweeps do not reach %.2f" % (name, mean(energies)))
                worst = min(worst, seconds / own_seconds)
                print("%s, %d rows: dwave-samplers %s %d sweeps %.2f s, mean %.2f +- %.2f, lowest %.2f; gonogo %d sweeps %.2f s, "
                      "mean %.2f, lowest %.2f: %.1f times as fast" % (
                          name, READS, rule, SWEEPS, seconds, mean(energies), error_of_mean(energies), min(energies), sweeps, own_seconds,
                          mean(own), min(own), seconds / own_seconds), flush=True)
    print("smallest factor %.1f (goal %.0f)" % (worst, TARGET))
    return 0 if worst >= TARGET else 1


if __name__ == "__main__":
    sys.exit(main())
