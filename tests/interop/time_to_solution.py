"""Time to solution of gonogo's samplers and of dwave-samplers' on ten families of problems, on one core.

    time_to_solution.py <gonogo> [family...]      run by scripts/time_to_solution.sh inside a virtual environment

Where THRML is installed, its block Gibbs is measured, too. It has no annealing schedule, so each sweep here scales its
weights by the next beta of dwave-samplers' geometric schedule. Problems that need more than MOST_BLOCKS colours are left
out: THRML compiles every block by itself. Compilation is not counted in its time.

The problems come from the generators of dimod and from graphs of dwave-networkx, PROBLEMS of each family. Every solver is
run at several efforts (sweeps of a read, moves or milliseconds of a tabu read). p is the share of its reads with the best energy
that any solver has found, t the CPU time of a read. Time to solution is t ln(0.01) / ln(1 - p), for its best effort; of a
family it is the geometric mean over the problems, with a 95 % interval by drawing p anew from its posterior. Half of the
reads choose the effort and the other half give p, so that the choice favours nobody. Ours is the time of the whole
program, start and files included; theirs is the time inside sample().
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
import warnings

import dimod
from dimod import generators

warnings.filterwarnings("ignore", category=DeprecationWarning)
import dwave_networkx
import networkx
from dwave.samplers import SimulatedAnnealingSampler, TabuSampler

try:
    import equinox
    import jax
    import numpy
    import thrml
    import thrml.models
except ImportError:
    thrml = None

PROBLEMS, SECONDS, MOST_READS, DRAWS = 2, 0.4, 20000, 1000
SWEEPS = (30, 200, 1500)
MOVES = (200, 2000, 20000)
TABU_MS = (2, 20)
MOST_BLOCKS = 20


def plain(bqm):
    """Variables 0 .. n - 1."""
    return bqm.relabel_variables({v: i for i, v in enumerate(bqm.variables)}, inplace=False)


def glass(graph, seed):
    return plain(generators.ran_r(1, graph, seed=seed))


def independent_set(seed):
    graph = networkx.random_regular_graph(3, 100, seed)
    return plain(generators.maximum_independent_set(graph.edges, graph.nodes))


def of_constraints(model):
    return plain(dimod.cqm_to_bqm(model)[0])


def salesman(cities, seed):
    draw = random.Random(seed)
    place = [(draw.random(), draw.random()) for _ in range(cities)]
    graph = networkx.Graph()
    for i in range(cities):
        for j in range(i):
            graph.add_edge(i, j, weight=math.dist(place[i], place[j]))
    bqm = dimod.BinaryQuadraticModel("BINARY")
    rest = list(range(1, cities))  # the tour begins at city 0
    for k in rest:
        for i in rest:
            bqm.add_linear((i, k), 0)
    for group in [[(i, k) for i in rest] for k in rest] + [[(i, k) for k in rest] for i in rest]:
        bqm.add_linear_equality_constraint([(v, 1) for v in group], 2.0, -1)
    for k in rest[:-1]:
        for i in rest:
            for j in rest:
                if i != j:
                    bqm.add_quadratic((i, k), (j, k + 1), graph[i][j]["weight"])
    for i in rest:
        bqm.add_linear((i, rest[0]), graph[0][i]["weight"])
        bqm.add_linear((i, rest[-1]), graph[0][i]["weight"])
    return plain(bqm)


def loops(seed):
    graph = dwave_networkx.pegasus_graph(4)
    return plain(generators.frustrated_loop(graph, len(graph) // 2, R=3, seed=seed))


FAMILIES = {
    "anti-crossing, clique": lambda k: plain(generators.anti_crossing_clique(40 + 8 * k)),
    "anti-crossing, loops": lambda k: plain(generators.anti_crossing_loops(40 + 8 * k)),
    "frustrated loops, Pegasus P4": loops,
    "independent set, 3-regular": independent_set,
    "knapsack": lambda k: of_constraints(generators.random_knapsack(10, seed=k)),
    "travelling salesman": lambda k: salesman(9, k),
    "glass, Chimera C8": lambda k: glass(dwave_networkx.chimera_graph(8), k),
    "glass, Zephyr Z3": lambda k: glass(dwave_networkx.zephyr_graph(3), k),
    "not-all-equal 3-SAT": lambda k: plain(generators.random_nae3sat(150, 300, seed=k)),
    "glass, complete graph": lambda k: glass(networkx.complete_graph(100), k),
}


class Annealing:
    """Theirs: geometric or linear schedule of their own betas."""
    efforts = SWEEPS

    def __init__(self, bqm, schedule):
        self.bqm, self.schedule = bqm, schedule

    def __call__(self, sweeps, reads, seed):
        start = time.process_time()
        found = SimulatedAnnealingSampler().sample(self.bqm, num_reads=reads, num_sweeps=sweeps, seed=seed,
                                                   beta_schedule_type=self.schedule)
        used = time.process_time() - start
        return used, list(map(float, self.bqm.energies(found)))


class Tabu:
    efforts = TABU_MS

    def __init__(self, bqm):
        self.bqm = bqm

    def __call__(self, milliseconds, reads, seed):
        start = time.process_time()
        found = TabuSampler().sample(self.bqm, num_reads=reads, timeout=milliseconds, seed=seed)
        used = time.process_time() - start
        return used, list(map(float, self.bqm.energies(found)))


class Thrml:
    """Annealing by THRML's block Gibbs: the blocks are the colours of the graph."""
    efforts = SWEEPS

    def __init__(self, bqm):
        self.bqm, self.ising = bqm, bqm.change_vartype("SPIN", inplace=False)
        graph = dimod.to_networkx_graph(self.ising)
        colour = networkx.greedy_color(graph, "DSATUR")
        self.blocks = [[v for v in graph if colour[v] == c] for c in sorted(set(colour.values()))]

    def anneal(self):
        """Compiles for keys [read] and betas [sweep]; gives the states of the blocks [read][spin]."""
        order = list(self.ising.variables)
        node = {v: thrml.SpinNode() for v in order}
        numbers = lambda values: jax.numpy.array([-x for x in values])  # THRML's energy has the other sign
        machine = thrml.models.IsingEBM([node[v] for v in order], [(node[a], node[b]) for a, b in self.ising.quadratic],
                                        numbers(self.ising.linear[v] for v in order), numbers(self.ising.quadratic.values()),
                                        jax.numpy.array(1.0))
        blocks = [thrml.Block([node[v] for v in block]) for block in self.blocks]
        program = thrml.models.IsingSamplingProgram(machine, blocks, [])
        samplers = [sampler.init() for sampler in program.samplers]

        def sweep(state, step):
            key, beta = step
            scaled = jax.tree.map(lambda x: x * beta if equinox.is_inexact_array(x) else x, program.per_block_interactions)
            at_beta = equinox.tree_at(lambda p: p.per_block_interactions, program, scaled)
            return thrml.sample_blocks(key, state, [], at_beta, list(samplers))[0], None

        def read(key, betas):
            start, later = jax.random.split(key)
            state = [jax.random.bernoulli(k, shape=(len(block),))
                     for k, block in zip(jax.random.split(start, len(blocks)), self.blocks)]
            return jax.lax.scan(sweep, state, (jax.random.split(later, len(betas)), betas))[0]

        return jax.jit(jax.vmap(read, (0, None)))

    def __call__(self, sweeps, reads, seed):
        probe = SimulatedAnnealingSampler().sample(self.bqm, num_reads=1, num_sweeps=1)
        betas = numpy.geomspace(*probe.info["beta_range"], sweeps)
        keys = jax.random.split(jax.random.key(seed), reads)
        compiled = self.anneal().lower(keys, betas).compile()
        start = time.process_time()
        state = [numpy.asarray(block) for block in compiled(keys, betas)]
        used = time.process_time() - start
        spins = 2 * numpy.concatenate(state, 1).astype(numpy.int8) - 1
        return used, list(map(float, self.ising.energies((spins, [v for block in self.blocks for v in block]))))


class Ours:

    def __init__(self, gonogo, bqm, *sampler, efforts=SWEEPS):
        self.gonogo, self.bqm, self.sampler, self.efforts = gonogo, bqm, sampler, efforts
        with open("problem.json", "w") as file:
            json.dump(bqm.to_serializable(), file)

    def __call__(self, sweeps, reads, seed):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([self.gonogo, "qubo", "sample", "problem.json", "--sampler", *self.sampler, "--reads", str(reads),
                        "--sweeps", str(sweeps), "--seed", str(seed), "--out", "answer.json"], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        with open("answer.json") as file:
            rows = dimod.SampleSet.from_serializable(json.load(file))
        energies = [float(e) for e, n in zip(self.bqm.energies(rows), rows.record.num_occurrences) for _ in range(n)]
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, energies


def solvers(gonogo, bqm):
    yield "gonogo anneal", Ours(gonogo, bqm, "anneal")
    yield "gonogo anneal linear", Ours(gonogo, bqm, "anneal", "--schedule", "linear")
    yield "gonogo tempering", Ours(gonogo, bqm, "tempering")
    yield "gonogo tabu", Ours(gonogo, bqm, "tabu", efforts=MOVES)
    yield "theirs, annealing", Annealing(bqm, "geometric")
    yield "theirs, annealing linear", Annealing(bqm, "linear")
    yield "theirs, tabu", Tabu(bqm)
    if thrml and len(Thrml(bqm).blocks) <= MOST_BLOCKS:
        yield "THRML", Thrml(bqm)


def measured(solver, effort):
    """Reads for at least half of SECONDS: their time, and all energies."""
    reads = 16
    while True:
        used, energies = solver(effort, reads, reads)
        if used >= SECONDS / 2 or reads >= MOST_READS:
            return used, energies
        reads = min(MOST_READS, max(2 * reads, int(reads * SECONDS / max(used, 1e-3))))


def drawn_time(seconds, hits, reads, draw):
    """Time to solution for p from its posterior under Jeffreys' prior; seconds: of a read."""
    p = draw.betavariate(hits + 0.5, reads - hits + 0.5)
    return seconds * max(1.0, math.log(0.01) / math.log1p(-p)) if p < 1 else seconds


def best_effort(runs, lowest):
    """Seconds of a read, hits and reads of the effort that is best by the even reads, counted on the odd ones."""
    slack = 1e-6 * max(1, abs(lowest))
    def half(run, first):
        hits = [e <= lowest + slack for e in run[1][first::2]]
        return run[0] / len(run[1]), sum(hits), len(hits)
    def expected(run):
        seconds, hits, reads = half(run, 0)
        p = (hits + 0.5) / (reads + 1)
        return seconds * max(1.0, math.log(0.01) / math.log1p(-p))
    return half(min(runs, key=expected), 1)


def family_times(gonogo, make):
    """By solver: for each problem seconds, hits, reads."""
    result = {}
    for k in range(PROBLEMS):
        bqm = make(k)
        runs = {name: [measured(solver, effort) for effort in solver.efforts] for name, solver in solvers(gonogo, bqm)}
        lowest = min(min(run[1]) for of in runs.values() for run in of)
        for name, of in runs.items():
            result.setdefault(name, []).append(best_effort(of, lowest))
    return result


def geometric_mean(values):
    return math.exp(sum(map(math.log, values)) / len(values))


def main():
    gonogo, chosen = os.path.abspath(sys.argv[1]), sys.argv[2:] or list(FAMILIES)
    draw, won = random.Random(1), 0
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        names = [name for name, _ in solvers(gonogo, dimod.BQM({"a": 1}, {}, "SPIN"))]
        print("| family | " + " | ".join(name + " [ms]" for name in names) + " | ours / theirs |")
        for family in chosen:
            times = family_times(gonogo, FAMILIES[family])
            draws = {name: sorted(geometric_mean([drawn_time(*problem, draw) for problem in of]) for _ in range(DRAWS))
                     for name, of in times.items()}
            unsorted = {name: [geometric_mean([drawn_time(*problem, draw) for problem in of]) for _ in range(DRAWS)]
                        for name, of in times.items()}
            def text(name):
                if name not in times:
                    return "not run"
                never = sum(hits == 0 for _, hits, _ in times[name])
                d = draws[name]
                return "%.3g [%.3g, %.3g]%s" % (1e3 * d[DRAWS // 2], 1e3 * d[DRAWS // 40], 1e3 * d[-DRAWS // 40],
                                               ", none on %d" % never if never else "")
            ratio = sorted(min(unsorted[n][i] for n in unsorted if n.startswith("gonogo")) /
                           min(unsorted[n][i] for n in unsorted if n.startswith("theirs")) for i in range(DRAWS))
            won += ratio[DRAWS // 2] <= 1
            print("| %s | %s | %.2g [%.2g, %.2g] |" % (family, " | ".join(map(text, names)), ratio[DRAWS // 2], ratio[DRAWS // 40],
                                                     ratio[-DRAWS // 40]), flush=True)
    print("ours is at most theirs in %d of %d families" % (won, len(chosen)))


if __name__ == "__main__":
    main()
