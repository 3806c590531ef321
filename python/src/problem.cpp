// Annealing problems: of models, and of dimod as arrays.
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "learning/formats/format.h"
#include "pipeline/outcome/answer/predictor.h"
#include "pipeline/outcome/qubo/qubo_exchange.h"
#include "python/src/binding.h"

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

using Parameters = std::vector<std::tuple<std::string, learning::SettingValue, std::string>>;

std::vector<std::tuple<std::string, std::string, std::string, Parameters>> drawing_samplers() {
  std::vector<std::tuple<std::string, std::string, std::string, Parameters>> list;
  for (const learning::SamplerKind* kind : learning::samplers()) {
    if (kind->origin != learning::RowOrigin::here) continue;
    Parameters parameters;
    for (const auto& p : kind->parameters) parameters.emplace_back(p.name, p.fallback, p.help);
    list.emplace_back(kind->name, kind->title, kind->about, std::move(parameters));
  }
  return list;
}

using Rows = std::tuple<Array<std::int8_t>, Array<double>, Array<std::int64_t>, Members>;

Rows rows_of(learning::SampleSet&& answer, const Json& info) {
  const std::size_t rows = answer.row_count(), variables = answer.variable_count();
  return {array_of(std::move(answer.values), {rows, variables}), array_of(std::move(answer.energies)),
          array_of(std::move(answer.occurrences)), members_of(info)};
}

Rows sample(const ProblemArrays& arrays, const SamplerChoice& choice, std::size_t reads, std::uint64_t seed,
            std::size_t sweeps) {
  learning::SampleSet rows = long_call([&] {
    const auto sampler = learning::make_sampler(choice.name, choice.settings);
    const learning::SampleRequest request{.reads = reads, .seed = seed, .sweeps = sweeps};
    return sampler->sample(problem_of(arrays), request);
  });
  const Json info = rows.info;
  return rows_of(std::move(rows), info);
}

outcome::MachineProblem machine_problem(const outcome::Predictor& predictor, const std::map<std::string, double>& given,
                                        const std::string& vartype, std::optional<double> code_penalty) {
  return long_call(
      [&] { return outcome::machine_problem(predictor.model(), given, vartype_named(vartype), code_penalty); });
}

/// Labels, linear biases, first and second variable of each coupling, its value, offset.
std::tuple<std::vector<std::string>, Array<double>, Array<std::uint32_t>, Array<std::uint32_t>, Array<double>, double>
coefficients(const outcome::MachineProblem& machine) {
  const learning::Problem& problem = machine.problem;
  std::vector<std::string> labels;
  for (const learning::Label& label : problem.labels) labels.push_back(learning::label_text(label));
  std::vector<std::uint32_t> first, second;
  std::vector<double> value;
  for (const learning::Coupling& c : problem.couplings) {
    first.push_back(c.a);
    second.push_back(c.b);
    value.push_back(c.value);
  }
  return {std::move(labels),          array_of(std::vector<double>(problem.linear)),
          array_of(std::move(first)), array_of(std::move(second)),
          array_of(std::move(value)), problem.offset};
}

outcome::Decoding decoding_named(const std::string& name) {
  for (const auto decoding : {outcome::Decoding::weigh, outcome::Decoding::discard, outcome::Decoding::repair})
    if (outcome::decoding_name(decoding) == name) return decoding;
  throw InputError("decoding " + name + ": there are weigh, discard and repair");
}

outcome::DecodeSettings decode_settings(const std::string& decoding, double min_reads, double min_share) {
  return {.decoding = decoding_named(decoding), .limits = {min_reads, min_share}};
}

/// The summary, and a list for every column of the rows.
using Decoded = std::tuple<Members, nb::typed<nb::dict, nb::str, nb::typed<nb::list, nb::any>>>;

Decoded decoded(const outcome::MachineProblem& machine, const learning::SampleSet& rows,
                const outcome::DecodeSettings& settings) {
  const outcome::ImportedAnswer answer = long_call([&] {
    const learning::SampleSet checked = learning::check_answer(machine.problem, rows, "answer");
    if (checked.row_count() == 0) throw InputError("answer: it has no rows; sample the problem with reads");
    return outcome::decode_answer_to(machine.problem, machine.sidecar, checked, settings, "answer");
  });
  const learning::VisibleLayout& layout = machine.sidecar.layout;
  nb::typed<nb::dict, nb::str, nb::typed<nb::list, nb::any>> columns;
  const auto add = [&](const std::string& name, const auto& of_row) {
    nb::list column;
    for (const outcome::DecodedAnswer::Row& row : answer.decoded.rows) column.append(of_row(row));
    columns[name.c_str()] = column;
  };
  for (std::size_t v = 0; v < layout.variable_count(); ++v)
    add(layout.encoders()[v].name(), [v](const auto& row) { return row.values[v]; });
  add("outcome", [&](const auto& row) { return layout.outcomes()[row.outcome]; });
  add("energy", [](const auto& row) { return row.energy; });
  add("occurrences", [](const auto& row) { return row.occurrences; });
  if (answer.decoded.decoding == outcome::Decoding::weigh) add("weight", [](const auto& row) { return row.weight; });
  return {members_of(outcome::to_json(answer)), columns};
}

/// `labels`: of the columns of `values` [row, variable]. `info`: of the sampler.
Decoded decode(const outcome::MachineProblem& machine, const std::string& vartype,
               const std::vector<std::variant<std::int64_t, std::string>>& labels,
               const ArrayIn<std::int8_t, 2>& values, const ArrayIn<double, 1>& energies,
               const ArrayIn<std::int64_t, 1>& occurrences, const Members& info, const std::string& decoding,
               double min_reads, double min_share) {
  learning::SampleSet rows;
  rows.vartype = vartype_named(vartype);
  for (const auto& label : labels) std::visit([&](const auto& name) { rows.labels.emplace_back(name); }, label);
  rows.values.assign(values.data(), values.data() + values.size());
  rows.energies = vector_of(energies);
  rows.occurrences.assign(occurrences.data(), occurrences.data() + occurrences.size());
  if (info.contains("problem_hash")) rows.info["problem_hash"] = nb::cast<std::string>(info["problem_hash"]);
  if (info.contains(learning::kSearchOf))
    rows.info[learning::kSearchOf] = nb::cast<std::string>(info[learning::kSearchOf]);
  if (info.contains("programmings")) rows.info["programmings"] = nb::cast<std::int64_t>(info["programmings"]);
  return decoded(machine, rows, decode_settings(decoding, min_reads, min_share));
}

Decoded sample_machine(const outcome::MachineProblem& machine, const SamplerChoice& choice, std::size_t reads,
                       std::uint64_t seed, std::size_t sweeps, const std::string& decoding) {
  const learning::SampleSet rows = long_call([&] {
    const auto sampler = learning::make_machine_sampler(choice.name, choice.settings);
    return sampler->sample(machine.problem, {.reads = reads, .seed = seed, .sweeps = sweeps});
  });
  return decoded(machine, rows, decode_settings(decoding, 0, 0));
}

Rows sample_emulated(const ProblemArrays& arrays, const outcome::DeviceChoice& device, std::size_t reads,
                     std::uint64_t seed, std::size_t sweeps) {
  std::optional<learning::Correction> correction;
  learning::SampleSet rows = long_call([&] {
    return outcome::emulated_rows({problem_of(arrays), {}}, device, {.reads = reads, .seed = seed, .sweeps = sweeps},
                                  correction);
  });
  outcome::SampleReport report = outcome::sample_report(rows);
  report.correction = correction;
  return rows_of(std::move(rows), outcome::to_json(report));
}

/// A machine on qubits that Python reaches. draw(labels, linear, first, second, coupling, offset, reads, seed) gives
/// the spins of a SPIN problem [reads, variable].
class PythonMachine final : public learning::Sampler {
 public:
  explicit PythonMachine(nb::callable draw) : draw_(std::move(draw)) {}
  ~PythonMachine() override {
    const nb::gil_scoped_acquire held;
    draw_.reset();
  }
  std::string name() const override { return "machine"; }
  learning::SampleSet sample(const learning::Problem& problem, const learning::SampleRequest& request) const override {
    const nb::gil_scoped_acquire held;
    std::vector<std::int64_t> labels;
    for (const learning::Label& label : problem.labels) labels.push_back(std::get<std::int64_t>(label));
    std::vector<std::uint32_t> first, second;
    std::vector<double> value;
    for (const learning::Coupling& c : problem.couplings) {
      first.push_back(c.a);
      second.push_back(c.b);
      value.push_back(c.value);
    }
    const auto spins = nb::cast<ArrayIn<std::int8_t, 2>>(
        draw_(labels, array_of(std::vector<double>(problem.linear)), array_of(std::move(first)),
              array_of(std::move(second)), array_of(std::move(value)), problem.offset, request.reads, request.seed));
    if (spins.shape(0) != request.reads || spins.shape(1) != problem.variable_count())
      throw InputError("machine: " + std::to_string(spins.shape(0)) + " rows of " + std::to_string(spins.shape(1)) +
                       " qubits came back where " + std::to_string(request.reads) + " of " +
                       std::to_string(problem.variable_count()) + " were asked for");
    learning::SampleSet rows{.vartype = problem.vartype, .labels = problem.labels};
    rows.values.assign(spins.data(), spins.data() + spins.size());
    rows.occurrences.assign(request.reads, 1);
    for (std::size_t r = 0; r < request.reads; ++r) rows.energies.push_back(learning::energy(problem, rows.row(r)));
    return rows;
  }

 private:
  nb::callable draw_;
};

Rows sample_corrected(const ProblemArrays& arrays, outcome::DeviceChoice device,
                      nb::typed<nb::callable, nb::object(...)> draw, std::size_t reads, std::uint64_t seed,
                      std::size_t sweeps) {
  device.machine = std::make_shared<PythonMachine>(std::move(draw));
  return sample_emulated(arrays, device, reads, seed, sweeps);
}

using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

std::tuple<std::vector<std::uint32_t>, Pairs> graph_of(const outcome::DeviceChoice& device) {
  const learning::HardwareGraph graph = outcome::chosen_graph(device.graph);
  return {graph.qubits(), graph.couplers()};
}

void bind_emulator(nb::module_& m) {
  using namespace nb::literals;
  nb::class_<outcome::DeviceChoice>(m, "Device", "An emulated annealer with the errors of a D-Wave 2X.")
      .def(
          "__init__",
          [](outcome::DeviceChoice* self, const std::string& graph, double dead_share, std::uint64_t dead_seed,
             double temperature, bool as_programmed, const std::string& solver) {
            new (self) outcome::DeviceChoice;
            self->graph.name = graph;
            self->graph.solver = solver;
            self->graph.dead_share = dead_share;
            self->graph.dead_seed = dead_seed;
            self->temperature = temperature;
            self->as_programmed = as_programmed;
          },
          "graph"_a, "dead_share"_a, "dead_seed"_a, "temperature"_a, "as_programmed"_a, "solver"_a = "");
  m.def("sample_emulated", &sample_emulated, "problem"_a, "device"_a, "reads"_a, "seed"_a, "sweeps"_a,
        "Rows of the device, as sample() gives them. The information says what was corrected.");
  m.def("sample_corrected", &sample_corrected, "problem"_a, "device"_a, "draw"_a, "reads"_a, "seed"_a, "sweeps"_a,
        "The same of a machine that draw(labels, linear, first, second, coupling, offset, reads, seed) reaches.");
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
  bind_emulator(m);
  nb::class_<SamplerChoice>(m, "SamplerChoice", "A sampler of the library and its settings.")
      .def(
          "__init__",
          [](SamplerChoice* self, const std::string& name, const learning::SamplerSettings& settings) {
            learning::make_sampler(name, settings);  // refuses names and values
            new (self) SamplerChoice{name, settings};
          },
          nb::arg("name"), nb::arg("settings") = learning::SamplerSettings());
  m.def("samplers", &drawing_samplers,
        "Samplers that draw rows here: name, class, description, and (name, default, help) of every parameter.");
  m.def("sample", &sample, nb::arg("problem"), nb::arg("sampler"), nb::arg("reads"), nb::arg("seed"), nb::arg("sweeps"),
        "Values [reads, variable_count], energies [reads], occurrences [reads], the sampler's information.");
  nb::class_<outcome::MachineProblem>(m, "MachineProblem", "A model's machine as an annealing problem.")
      .def(nb::new_(&machine_problem), nb::arg("predictor"), nb::arg("given"), nb::arg("vartype"),
           nb::arg("code_penalty").none())
      .def("coefficients", &coefficients,
           "Labels, linear biases, first and second variable of each coupling, its value, offset.")
      .def("decode", &decode, nb::arg("vartype"), nb::arg("labels"), nb::arg("values"), nb::arg("energies"),
           nb::arg("occurrences"), nb::arg("info"), nb::arg("decoding"), nb::arg("min_reads"), nb::arg("min_share"),
           "Checks and decodes an answer. Returns its summary, and a list for every column of the rows.")
      .def("sample", &sample_machine, nb::arg("sampler"), nb::arg("reads"), nb::arg("seed"), nb::arg("sweeps"),
           nb::arg("decoding"), "Draws rows and decodes them.");
}

}  // namespace gonogo::python
