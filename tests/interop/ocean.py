"""The program's files against the programs they are for: dimod, bqpjson, dwave-cloud-client, dwave-graphs, dwave-samplers.

    ocean.py <gonogo> <source folder>      run by scripts/interop.sh inside a virtual environment
"""
import base64
import io
import json
import os
import pickle
import random
import struct
import subprocess
import sys
import tempfile

import bqpjson
import dimod
import dwave_networkx
import numpy
from dimod.serialization import coo
from dwave.cloud import Client
from dwave.cloud.coders import decode_qp, decode_qp_numpy, encode_problem_as_qp
from dwave.cloud.solver import StructuredSolver
from dwave.cloud.testing.mocks import qpu_chimera_solver_data

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from sapi_server import SapiServer

GONOGO, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
checks = 0


def check(condition, fact):
    global checks
    if not condition:
        raise SystemExit("interop: FAILED: " + fact)
    checks += 1


def gonogo(*arguments):
    done = subprocess.run([GONOGO, *arguments], capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit("interop: " + " ".join(arguments) + "\n" + done.stderr)
    return done.stdout


def read(path):
    with open(path, "rb") as file:
        return file.read()


def write(path, content):
    with open(path, "wb") as file:
        file.write(content if isinstance(content, bytes) else content.encode())


def random_problem(vartype, count, label):
    bqm = dimod.BinaryQuadraticModel(vartype)
    for i in range(count):
        bqm.add_variable(label(i), random.uniform(-1, 1))
    for i in range(count):
        for j in range(i):
            if random.random() < 0.4:
                bqm.add_quadratic(label(i), label(j), random.uniform(-1, 1))
    bqm.offset = 0.37
    return bqm


def problem_files():
    for vartype in ("BINARY", "SPIN"):
        bqm = random_problem(vartype, 12, lambda i: "v%02d" % i)  # dimod sorts labels in its JSON
        write("given.bqm", bqm.to_file().read())
        gonogo("qubo", "convert", "given.bqm", "--out", "back.bqm")
        check(read("back.bqm") == read("given.bqm"), "DIMODBQM version 2 has dimod's bytes")
        gonogo("qubo", "convert", "given.bqm", "--to", "dimod_bqm_v1", "--out", "v1.bqm")
        check(read("v1.bqm") == bqm.to_file(version=1).read(), "DIMODBQM version 1 has dimod's bytes")
        gonogo("qubo", "convert", "given.bqm", "--out", "given.json")
        text = json.dumps(bqm.to_serializable(), separators=(",", ":")) + "\n"
        check(read("given.json") == text.encode(), "dimod's JSON has dimod's bytes")
        check(dimod.BinaryQuadraticModel.from_serializable(json.loads(read("given.json"))) == bqm, "dimod reads the JSON")
    numbered = random_problem("BINARY", 10, lambda i: i)
    numbered.offset = 0
    write("n.bqm", numbered.to_file().read())
    gonogo("qubo", "convert", "n.bqm", "--out", "n.coo")
    check(coo.loads(read("n.coo").decode()) == numbered, "dimod reads the coordinate text to the last bit")
    numbered = dimod.BinaryQuadraticModel({0: -1, 1: 0, 2: 2.5}, {(0, 1): 1, (1, 2): -4.5}, 0, "BINARY")
    write("n.bqm", numbered.to_file().read())
    gonogo("qubo", "convert", "n.bqm", "--out", "n.coo")
    text = read("n.coo").decode().replace("# 4 coefficients\n", "")
    check(text == coo.dumps(numbered, vartype_header=True) + "\n", "coordinate text has dimod's bytes but for its count")


LABELS = [lambda i: i, lambda i: i + 5, lambda i: -i, lambda i: "v%d" % i, lambda i: "\u00fc,\"%d\"\n" % i, lambda i: (0, i),
          lambda i: (i, (1, "a"), 2), lambda i: (0, 0, i % 2, i), lambda i: i + 0.5, lambda i: (i / 4 + 0.1,), lambda i: ((i,),),
          lambda i: 2**62 + i, lambda i: [i, "x%d" % i, (i, 0), i + 0.25][i % 4]]


def hostile(k):
    """The k-th of 65 problems of dimod's own kinds: all labels, hard numbers, no couplings, no variables, float32."""
    rng = random.Random(k)
    label, vartype = LABELS[k % len(LABELS)], ("BINARY", "SPIN")[k % 2]
    hard = [0.0, -0.0, 1e-300, 5e-324, -1e300, 1 / 3, 1e15, 1e16, 123456789012345678.0]
    number = lambda: rng.choice(hard) if rng.random() < 0.4 else rng.uniform(-2, 2)
    bqm = dimod.BinaryQuadraticModel(vartype)
    count = [0, 1, 5, 12, 40][k // len(LABELS)]
    for i in range(count):
        bqm.add_variable(label(i), number())
    for i in range(count):
        for j in range(i):
            if rng.random() < 0.3:
                bqm.add_quadratic(label(i), label(j), number())
    bqm.offset = number() + 0.0  # dimod's reader of JSON drops the sign of a zero offset
    return bqm


def tuples(label):
    return tuple(map(tuples, label)) if isinstance(label, list) else label


def from_json(path):
    """dimod's reader makes tuples of the outermost lists alone; labels of labels are made tuples here."""
    data = json.loads(read(path))
    data["variable_labels"] = [tuples(label) for label in data["variable_labels"]]
    return dimod.BinaryQuadraticModel.from_serializable(data)


def hostile_files():
    for k in range(65):
        bqm = hostile(k)
        write("h.bqm", bqm.to_file().read())
        gonogo("qubo", "convert", "h.bqm", "--out", "h.json")
        gonogo("qubo", "convert", "h.json", "--out", "h_back.bqm")
        check(read("h_back.bqm") == read("h.bqm"), "hostile problem %d: dimod's bytes through our JSON and back" % k)
        ours = from_json("h.json")
        check(ours.to_file().read() == read("h.bqm"), "hostile problem %d: dimod reads our JSON to the last bit" % k)
        check(dimod.BinaryQuadraticModel.from_file(read("h_back.bqm")).variables == bqm.variables, "labels of problem %d" % k)
        write("d.json", json.dumps(bqm.to_serializable()))
        gonogo("qubo", "convert", "d.json", "--out", "d.bqm")
        theirs = from_json("d.json")
        check(read("d.bqm") == theirs.to_file().read(), "hostile problem %d: dimod's JSON to the last bit" % k)
        if len(bqm) > 0:
            gonogo("qubo", "sample", "h.bqm", "--sampler", "anneal", "--reads", "3", "--sweeps", "2", "--out", "h_rows.json")
            data = json.loads(read("h_rows.json"))
            data["variable_labels"] = [tuples(label) for label in data["variable_labels"]]
            rows = dimod.SampleSet.from_serializable(data)
            check(set(rows.variables) == set(bqm.variables), "dimod reads the labels of our rows, problem %d" % k)


def refused(reason, *arguments):
    done = subprocess.run([GONOGO, *arguments], capture_output=True, text=True)
    check(done.returncode == 2 and reason in done.stderr, "refused with \"%s\": %s" % (reason, done.stderr))


def foreign_files():
    cqm = dimod.ConstrainedQuadraticModel()
    cqm.set_objective(dimod.Binary("x"))
    cqm.add_constraint(dimod.Binary("x") <= 1)
    dqm = dimod.DiscreteQuadraticModel()
    dqm.add_variable(3)
    qm = dimod.QuadraticModel()
    qm.add_variable("INTEGER", "i")
    bqm = dimod.BinaryQuadraticModel({"x": 1}, {}, 0, "BINARY")
    for name, content, reason in (("a.cqm", cqm.to_file().read(), "CQM"), ("a.dqm", dqm.to_file().read(), "DQM"),
                                  ("a.qm", qm.to_file().read(), "(QM)"), ("a.lp", dimod.lp.dumps(cqm), "LP file"),
                                  ("a.pickle", pickle.dumps(bqm), "pickle"), ("a.json", pickle.dumps(bqm), "pickle")):
        write(name, content)
        refused(reason, "qubo", "convert", name, "--out", "x.json")
    write("a.unknown", "1 2 3")
    refused("say which with --from", "qubo", "convert", "a.unknown", "--out", "x.json")
    write("b.bqm", bqm.to_file().read())
    refused("say which with --to", "qubo", "convert", "b.bqm", "--out", "x.unknown")
    for empty in (dimod.SampleSet.from_samples([], "BINARY", energy=[]),
                  dimod.SampleSet.from_samples((numpy.empty((0, 1), dtype="int8"), ["x"]), "BINARY", energy=[])):
        write("empty.json", json.dumps(empty.to_serializable()))
        gonogo("qubo", "convert", "b.bqm", "--out", "b.json")
        done = subprocess.run([GONOGO, "qubo", "import", "--problem", "b.json", "--answer", "empty.json"],
                              capture_output=True, text=True)
        check(done.returncode == 2 and ("no rows" in done.stderr or "variables" in done.stderr), "empty: " + done.stderr)


def bridge_without():
    """Without dimod, and without a machine, the bridge ends in a sentence."""
    bare = subprocess.run([sys.executable, "-S", "-E", os.path.join(SOURCE, "scripts", "ocean_bridge.py"), "p", "a",
                           "--sampler", "annealer"], capture_output=True, text=True, env={"PATH": os.environ["PATH"]})
    check(bare.returncode == 1 and bare.stderr.startswith("ocean_bridge.py: dimod is not installed"), bare.stderr)
    bqm = random_problem("BINARY", 4, lambda i: i)
    write("q.bqm", bqm.to_file().read())
    done = subprocess.run([sys.executable, os.path.join(SOURCE, "scripts", "ocean_bridge.py"), "q.bqm", "q.json",
                           "--sampler", "qpu"], capture_output=True, text=True)
    check(done.returncode == 1 and done.stderr.startswith("ocean_bridge.py: ") and "Traceback" not in done.stderr, done.stderr)


def bqpjson_files():
    bqm = random_problem("BINARY", 9, lambda i: i)
    write("b.bqm", bqm.to_file().read())
    gonogo("qubo", "convert", "b.bqm", "--out", "b.bqpjson")
    gonogo("qubo", "convert", "b.bqm", "--out", "b.qubo")
    data = json.loads(read("b.bqpjson"))
    bqpjson.validate(data)
    check((json.dumps(data, sort_keys=True) + "\n").encode() == read("b.bqpjson"), "bqpjson has bqpjson's bytes")
    out = io.StringIO()
    bqpjson.core.bqpjson_to_qubo(data, out)
    check(out.getvalue().encode() == read("b.qubo"), "qbsolv text has the bytes of bqp2qubo")


def solver_definition():
    data = qpu_chimera_solver_data(4)
    data["properties"]["topology"] = {"type": "chimera", "shape": [4, 4, 4]}
    write("solver.json", json.dumps(data))
    return StructuredSolver(client=None, data=data)


def sapi():
    solver = solver_definition()
    check({tuple(sorted(e)) for e in solver.edges} == {tuple(sorted(e)) for e in dwave_networkx.chimera_graph(4).edges},
          "the mock solver is C4")
    bqm = random_problem("SPIN", 10, lambda i: "v%d" % i)
    write("logical.bqm", bqm.to_file().read())
    gonogo("qubo", "embed", "logical.bqm", "--on-solver", "solver.json", "--out", "physical.json", "--gauge", "3")
    physical = dimod.BinaryQuadraticModel.from_serializable(json.loads(read("physical.json")))
    gonogo("qubo", "convert", "physical.json", "--to", "sapi", "--to-solver", "solver.json", "--out", "p.sapi.json")
    body = json.loads(read("p.sapi.json"))[0]
    wanted = encode_problem_as_qp(solver, dict(physical.linear), dict(physical.quadratic), offset=physical.offset)
    check(body["data"] == wanted, "the SAPI problem has the cloud client's bytes")
    gonogo("qubo", "sample", "physical.json", "--sampler", "tempering", "--reads", "20", "--sweeps", "50", "--out", "rows.json")
    rows = dimod.SampleSet.from_serializable(json.loads(read("rows.json")))
    check(len(rows) == 20 and (abs(rows.record.energy - physical.energies(rows)) < 1e-9).all(), "dimod reads the answer")
    answer = encode_answer(rows, physical)
    write("answer.json", json.dumps(answer))
    for decode in (decode_qp, decode_qp_numpy):
        decoded = decode(json.loads(json.dumps(answer)))
        check([decoded["solutions"][0][q] for q in sorted(physical.variables)] ==
              [rows.record.sample[0][list(rows.variables).index(q)] for q in sorted(physical.variables)], "client decodes")
    report = gonogo("qubo", "import", "--problem", "physical.json", "--answer", "answer.json", "--answer-format", "sapi")
    check("20 reads, energies verified" in report, "a SAPI answer is imported through gauge and embedding")


def encode_answer(rows, bqm, chip_size=128):
    qubits = sorted(bqm.variables)
    order = [list(rows.variables).index(q) for q in qubits]
    solutions = b""
    for row in rows.record.sample:
        bits = "".join("1" if row[k] > 0 else "0" for k in order)
        bits += "0" * (-len(bits) % 8)
        solutions += int(bits, 2).to_bytes(len(bits) // 8, "big")
    pack = lambda kind, values: base64.b64encode(struct.pack("<%d%s" % (len(values), kind), *values)).decode()
    return {"type": "ising", "status": "COMPLETED", "answer": {
        "format": "qp", "num_variables": chip_size, "active_variables": pack("i", qubits),
        "energies": pack("d", list(rows.record.energy)), "solutions": base64.b64encode(solutions).decode(), "timing": {}}}


def bridge():
    bqm = random_problem("BINARY", 8, lambda i: "v%d" % i)
    write("bridge.bqm", bqm.to_file().read())
    command = [sys.executable, os.path.join(SOURCE, "scripts", "ocean_bridge.py"), "{problem}", "{answer}",
               "--reads={reads}", "--seed={seed}"]
    for sampler in ("annealer", "tree"):
        gonogo("qubo", "sample", "bridge.bqm", "--sampler", "command", "--reads", "50", "--out", "bridged.json",
               "--", *command, "--sampler", sampler)
        rows = dimod.SampleSet.from_serializable(json.loads(read("bridged.json")))
        check(len(rows) == 50 and rows.info["ocean_sampler"] == sampler, "dwave-samplers solves our problem: " + sampler)


def emulated(body):
    """What the loopback server does with a posted problem: the program's emulator of a D-Wave 2X."""
    write("posted.sapi.json", json.dumps([body]))
    gonogo("qubo", "sample", "posted.sapi.json", "--from", "sapi", "--solver", "c12.json", "--sampler", "emulator",
           "--dead-share", "0", "--reads", str(body["params"]["num_reads"]), "--sweeps", "100", "--out", "emulated.json")
    rows = dimod.SampleSet.from_serializable(json.loads(read("emulated.json")))
    gonogo("qubo", "convert", "posted.sapi.json", "--from", "sapi", "--solver", "c12.json", "--out", "posted.json")
    posted = dimod.BinaryQuadraticModel.from_serializable(json.loads(read("posted.json")))
    posted.offset = 0  # SAPI serves energies without it, the client adds it
    rows = dimod.SampleSet.from_samples_bqm((rows.record.sample, rows.variables), posted)
    return encode_answer(rows, posted, 1152)["answer"]


def loopback():
    """The real client submits our problem over HTTP, the emulator answers behind the server, we decode the answer."""
    data = qpu_chimera_solver_data(12)
    data["properties"]["topology"] = {"type": "chimera", "shape": [12, 12, 4]}
    data["properties"]["parameters"].update({"answer_mode": "raw or histogram", "auto_scale": "scale to the full range"})
    write("c12.json", json.dumps(data))
    bqm = random_problem("SPIN", 8, lambda i: "v%d" % i)
    bqm.scale(0.2)
    write("small.bqm", bqm.to_file().read())
    gonogo("qubo", "embed", "small.bqm", "--on-solver", "c12.json", "--out", "on_chip.json", "--gauge", "5", "--chain-strength", "0.9")
    on_chip = dimod.BinaryQuadraticModel.from_serializable(json.loads(read("on_chip.json")))
    with SapiServer(data, emulated) as server:
        with Client(endpoint=server.endpoint, token=server.token, config_file=False) as client:
            solver = client.get_solver(refresh=True)
            check(solver.num_active_qubits == 1152, "the client reads the solver that the loopback server serves")
            future = solver.sample_ising(dict(on_chip.linear), dict(on_chip.quadratic), offset=on_chip.offset,
                                         num_reads=40, answer_mode="raw", auto_scale=False, label="go or no go")
            rows = future.sampleset
            check(len(rows) == 40 and server.polls > 0, "the client polls until the answer is there")
            check((abs(rows.record.energy - on_chip.energies(rows)) < 1e-9).all(), "the client decodes rows and energies")
            wanted = json.loads(read_after("qubo", "convert", "on_chip.json", "--to", "sapi", "--to-solver", "c12.json"))[0]
            posted = server.posted[0]
            check(posted["data"] == wanted["data"] and posted["type"] == wanted["type"], "it posts what the program writes")
            write("served.json", json.dumps(next(iter(server.problems.values()))))
            report = gonogo("qubo", "import", "--problem", "on_chip.json", "--answer", "served.json", "--answer-format", "sapi")
            check("40 reads, energies verified" in report, "the served answer is decoded through gauge and embedding")
        with Client(endpoint=server.endpoint, token="wrong", config_file=False) as client:
            try:
                client.get_solvers(refresh=True)
                check(False, "a wrong token is refused")
            except Exception as error:
                check("token" in str(error).lower() or "Auth" in type(error).__name__, "a wrong token is refused")


def read_after(*arguments):
    gonogo(*arguments, "--out", "converted.sapi.json")
    return read("converted.sapi.json")


def main():
    random.seed(3)
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        problem_files()
        hostile_files()
        foreign_files()
        bqpjson_files()
        sapi()
        bridge()
        bridge_without()
        loopback()
        os.chdir("/")
    print("interop: %d facts hold" % checks)


main()
