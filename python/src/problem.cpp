// Annealing problems: of models, and of dimod as arrays.
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "pipeline/learn/qubo/emulated_annealer.h"
#include "python/src/arrays.h"
#include "python/src/calls.h"
#include "python/src/module.h"

namespace nb = nanobind;

namespace gonogo::python {
namespace {

learning::Vartype vartype_named(const std::string& name) {
  if (name == "BINARY") return learning::Vartype::binary;
  if (name == "SPIN") return learning::Vartype::spin;
  throw InputError("vartype " + name + ": there are BINARY and SPIN");
}

struct ProblemArrays {
  std::string vartype;
  std::vector<std::int64_t> labels;
  ArrayIn<double, 1> linear;                // [variable_count]
  ArrayIn<std::uint32_t, 1> first, second;  // [coupling_count], first < second, ascending
  ArrayIn<double, 1> coupling;              // [coupling_count]
  double offset;
};

learning::Problem problem_of(const ProblemArrays& arrays) {
  if (arrays.first.size() != arrays.coupling.size() || arrays.second.size() != arrays.coupling.size())
    throw InputError("problem: the three arrays of its couplings differ in length");
  learning::Problem problem;
  problem.vartype = vartype_named(arrays.vartype);
  problem.labels.assign(arrays.labels.begin(), arrays.labels.end());
  problem.linear = vector_of(arrays.linear);
  for (std::size_t k = 0; k < arrays.coupling.size(); ++k)
    problem.couplings.push_back({arrays.first.data()[k], arrays.second.data()[k], arrays.coupling.data()[k]});
  problem.offset = arrays.offset;
  learning::check_problem(problem, "problem");
  return problem;
}

struct SamplerChoice {
  std::string name;
  learning::SamplerSettings settings;
};

using Rows = std::tuple<Array<std::int8_t>, Array<double>, Array<std::int64_t>, std::string>;

Rows rows_of(learning::SampleSet&& answer) {
  const std::size_t rows = answer.row_count(), variables = answer.variable_count();
  return {array_of(std::move(answer.values), {rows, variables}), array_of(std::move(answer.energies)),
          array_of(std::move(answer.occurrences)), answer.info.dump()};
}

Rows sample(const ProblemArrays& arrays, const SamplerChoice& choice, std::size_t reads, std::uint64_t seed,
            std::size_t sweeps) {
  return rows_of(long_call([&] {
    const auto sampler = learning::make_sampler(choice.name, choice.settings);
    const learning::SampleRequest request{.reads = reads, .seed = seed, .sweeps = sweeps};
    return sampler->sample(problem_of(arrays), request);
  }));
}

std::vector<std::string> export_problem(const std::string& model, const std::string& problem,
                                        const std::map<std::string, double>& given, const std::string& vartype,
                                        std::optional<double> code_penalty) {
  return long_call(
      [&] { return learn::export_problem(model, problem, given, vartype_named(vartype), {}, code_penalty).notes; });
}

learn::Decoding decoding_named(const std::string& name) {
  for (const auto decoding : {learn::Decoding::weigh, learn::Decoding::discard, learn::Decoding::repair})
    if (learn::decoding_name(decoding) == name) return decoding;
  throw InputError("decoding " + name + ": there are weigh, discard and repair");
}

std::string import_answer(const std::string& problem, const std::string& answer, const std::string& model,
                          const std::string& rows, const std::string& decoding, double min_reads, double min_share) {
  return long_call([&] {
    learn::ImportRequest request;
    request.problem = problem;
    request.answer = answer;
    request.model = model;
    request.rows = rows;
    request.decoding = decoding_named(decoding);
    request.limits = {min_reads, min_share};
    return learn::import_answer(request).dump();
  });
}

void sample_file(const std::string& problem, const std::string& answer, const SamplerChoice& choice, std::size_t reads,
                 std::uint64_t seed, std::size_t sweeps) {
  long_call([&] {
    const auto sampler = learning::make_sampler(choice.name, choice.settings);
    learn::sample_problem(problem, answer, *sampler, {.reads = reads, .seed = seed, .sweeps = sweeps});
  });
}

std::string sample_emulated(const std::string& problem, const std::string& answer, const learn::DeviceChoice& device,
                            std::size_t reads, std::uint64_t seed, std::size_t sweeps) {
  return long_call([&] {
    return learn::sample_emulated(problem, answer, device, {.reads = reads, .seed = seed, .sweeps = sweeps}).dump();
  });
}

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

std::tuple<std::vector<std::uint32_t>, Pairs> graph_of(const learn::DeviceChoice& device) {
  const learning::HardwareGraph graph = learn::chosen_graph(device.graph);
  return {graph.qubits(), graph.couplers()};
}

void bind_device(nb::module_& m) {
  using namespace nb::literals;
  nb::class_<learn::DeviceChoice>(m, "Device", "An emulated annealer with the errors of a D-Wave 2X.")
      .def(
          "__init__",
          [](learn::DeviceChoice* self, const std::string& graph, double dead_share, std::uint64_t dead_seed,
             double temperature, bool as_programmed) {
            new (self) learn::DeviceChoice;
            self->graph.name = graph;
            self->graph.dead_share = dead_share;
            self->graph.dead_seed = dead_seed;
            self->temperature = temperature;
            self->as_programmed = as_programmed;
          },
          "graph"_a, "dead_share"_a, "dead_seed"_a, "temperature"_a, "as_programmed"_a);
  m.def("sample_emulated", &sample_emulated, "problem"_a, "answer"_a, "device"_a, "reads"_a, "seed"_a, "sweeps"_a,
        "Samples a problem file and writes the answer in dimod's JSON. Returns JSON of what was corrected.");
  m.def("graph_of", &graph_of, "device"_a, "Qubits and couplers.");
}

}  // namespace

void bind_problem(nb::module_& m) {
  nb::class_<ProblemArrays>(m, "Problem", "E(x) = offset + linear . x + sum of coupling[k] x[first[k]] x[second[k]].")
      .def(
          "__init__",
          [](ProblemArrays* self, const std::string& vartype, std::vector<std::int64_t> labels,
             ArrayIn<double, 1> linear, ArrayIn<std::uint32_t, 1> first, ArrayIn<std::uint32_t, 1> second,
             ArrayIn<double, 1> coupling, double offset) {
            new (self) ProblemArrays{vartype, std::move(labels), linear, first, second, coupling, offset};
          },
          nb::arg("vartype"), nb::arg("labels"), nb::arg("linear"), nb::arg("first"), nb::arg("second"),
          nb::arg("coupling"), nb::arg("offset"));
  bind_device(m);
  nb::class_<SamplerChoice>(m, "SamplerChoice", "A sampler of the library and its settings.")
      .def(
          "__init__",
          [](SamplerChoice* self, const std::string& name, double beta_start, double beta_end, std::size_t replicas,
             std::size_t temperatures, bool on_gpu) {
            new (self) SamplerChoice{name, {}};
            self->settings.beta_start = beta_start;
            self->settings.beta_end = beta_end;
            self->settings.replicas = replicas;
            self->settings.temperatures = temperatures;
            self->settings.on_gpu = on_gpu;
          },
          nb::arg("name"), nb::arg("beta_start") = 0.1, nb::arg("beta_end") = 1.0, nb::arg("replicas") = 10,
          nb::arg("temperatures") = 30, nb::arg("on_gpu") = false);
  m.def("sample", &sample, nb::arg("problem"), nb::arg("sampler"), nb::arg("reads"), nb::arg("seed"), nb::arg("sweeps"),
        "Values [reads, variable_count], energies [reads], occurrences [reads], JSON of the sampler's information.");
  m.def("export_problem", &export_problem, nb::arg("model"), nb::arg("problem"), nb::arg("given"), nb::arg("vartype"),
        nb::arg("code_penalty").none(), "Writes a model's problem and its sidecar. Returns notes, a sentence each.");
  m.def("import_answer", &import_answer, nb::arg("problem"), nb::arg("answer"), nb::arg("model"), nb::arg("rows"),
        nb::arg("decoding"), nb::arg("min_reads"), nb::arg("min_share"),
        "Checks and decodes an answer in dimod's JSON. Writes the rows as CSV. Returns JSON.");
  m.def("sample_file", &sample_file, nb::arg("problem"), nb::arg("answer"), nb::arg("sampler"), nb::arg("reads"),
        nb::arg("seed"), nb::arg("sweeps"), "Samples a problem file and writes the answer in dimod's JSON.");
}

}  // namespace gonogo::python
