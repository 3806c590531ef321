// A machine goes out as a problem and comes back as an answer.
#include "pipeline/outcome/qubo/qubo_exchange.h"

#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/files/file.h"
#include "learning/formats/dimod.h"
#include "learning/model/posterior.h"
#include "pipeline/outcome/answer/infer.h"
#include "pipeline/outcome/qubo/qubo_embed.h"
#include "pipeline/outcome/training_data.h"
#include "tests/pipeline/outcome/random_machine.h"
#include "tests/pipeline/outcome/synthetic_trials.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::outcome;
namespace fs = std::filesystem;

namespace {

const TemporaryFolder kScratch;
const fs::path kFolder = kScratch.path();
const fs::path kModel = kFolder / "model.h5", kProblem = kFolder / "problem.json", kAnswer = kFolder / "answer.json";

/// A machine of moderate weights over a layout small enough that code words are common among its rows.
learning::Model write_small_model() {
  learning::Model model = random_machine({.hidden = 5});
  give_trials(model);
  learning::write_model(kModel, model);
  return model;
}

ImportRequest import_request() {
  ImportRequest request;
  request.problem = kProblem;
  request.answer = kAnswer;
  return request;
}

/// P(outcome | clamped) of the machine's own joint distribution.
std::vector<double> own_probabilities(const learning::Model& model, const std::map<std::string, double>& clamped) {
  return learning::Posterior(model.layout, model.weights).marginal(to_variables(clamped)).probability;
}

/// Largest difference to `expected` in standard errors of the answer.
double largest_z(const Json& answer, const std::vector<double>& expected) {
  double worst = 0;
  for (std::size_t y = 0; y < expected.size(); ++y) {
    const Json& entry = answer.at("outcomes").at(contract().outcomes[y].name);
    worst =
        std::max(worst, std::abs(entry.at("frequency").number() - expected[y]) / entry.at("standard_error").number());
  }
  return worst;
}

void replace_in_file(const fs::path& path, const std::string& from, const std::string& to) {
  std::string text = read_file(path);
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  write_file_atomically(path, text.replace(at, from.size(), to));
}

}  // namespace

TEST_CASE("outcome frequencies of an imported answer are the machine's conditional probabilities") {
  const learning::Model model = write_small_model();
  const auto vartype = GENERATE(learning::Vartype::binary, learning::Vartype::spin);
  const std::string sampler = GENERATE("block_gibbs", "exact");
  const std::map<std::string, double> clamped = {{"slope_along", 12}, {"friction_angle", 31}};
  export_problem(kModel, kProblem, clamped, vartype);
  sample_problem(kProblem, kAnswer, *learning::make_sampler(sampler), {.reads = 60000, .seed = 11, .sweeps = 60});
  ImportRequest import = import_request();
  import.model = kModel;
  import.rows = kFolder / "rows.csv";
  import.decoding = Decoding::discard;
  const Json answer = to_json(import_answer(import));
  const auto expected = learning::Posterior(model.layout, model.weights).marginal(to_variables(clamped)).probability;
  double worst = 0;
  for (std::size_t y = 0; y < expected.size(); ++y) {
    const Json& entry = answer.at("outcomes").at(contract().outcomes[y].name);
    const double error = std::sqrt(expected[y] * (1 - expected[y]) / answer.at("valid").number());
    worst = std::max(worst, std::abs(entry.at("frequency").number() - expected[y]) / error);
  }
  std::printf("%s %s: %.0f of %.0f rows valid; largest z of %zu outcome frequencies %.2f\n", sampler.c_str(),
              learning::vartype_name(vartype).c_str(), answer.at("valid").number(), answer.at("reads").number(),
              expected.size(), worst);
  CHECK(answer.at("valid").number() > 5000);
  CHECK(answer.at("repaired").number() == 0);
  CHECK(worst < 4);
  CHECK(answer.at("variables").at("slope_along").at("mean").number() == Approx(12));
  CHECK(read_file(kFolder / "rows.csv").rfind("slope_along,", 0) == 0);
}

TEST_CASE("the whole machine goes out with every unit and its energies intact") {
  const learning::Model model = write_small_model();
  const Sidecar sidecar = export_problem(kModel, kProblem, {}, learning::Vartype::binary, {}, 0.0).sidecar;
  CHECK(sidecar.labels.size() == model.weights.visible_count + 5);
  const auto problem = learning::problem_from_dimod_json(read_file(kProblem), "problem");
  CHECK(problem == learning::to_qubo(model.weights, model.layout.unit_labels()));
  CHECK(read_sidecar(learning::sidecar_path(kProblem)).problem_hash == sidecar.problem_hash);
}

TEST_CASE("a sidecar in which any number was changed is refused, whatever the layout of its text") {
  write_small_model();
  export_problem(kModel, kProblem, {{"slope_along", 12}}, learning::Vartype::binary);
  const fs::path path = learning::sidecar_path(kProblem);
  const std::string whole = read_file(path);
  int changed = 0;
  for (std::size_t at = whole.find_first_of("0123456789"); at != std::string::npos;
       at = whole.find_first_of("0123456789", at + 1)) {
    std::string text = whole;
    text[at] = text[at] == '9' ? '8' : char(text[at] + 1);
    write_file_atomically(path, text);
    INFO("byte " << at << " of " << whole.size());
    std::string json;
    try {
      json = Json::parse(text, "changed").dump();
    } catch (const InputError&) {
    }
    if (json == Json::parse(whole, "sidecar").dump()) continue;  // a 17th digit that names the same number
    CHECK_THROWS_AS(read_sidecar(path), InputError);
    ++changed;
  }
  CHECK(changed > 300);
  write_file_atomically(path, whole);
  replace_in_file(path, "\"upper\": ", "\"upper\":  1e308, \"was\": ");
  refused([&] { read_sidecar(path); }, "was");
  write_file_atomically(path, Json::parse(whole, "sidecar").dump());
  CHECK(read_sidecar(path).clamped.at("slope_along") == 12);
}

TEST_CASE("a penalty leaves few rows that are no code words, and the outcomes' frequencies as they were") {
  const learning::Model model = write_small_model();
  const std::map<std::string, double> clamped = {{"slope_along", 12}, {"friction_angle", 31}};
  const auto expected = learning::Posterior(model.layout, model.weights).marginal(to_variables(clamped)).probability;
  std::vector<double> invalid;
  for (double penalty : {0.0, 3.0, 6.0}) {
    const Sidecar sidecar = export_problem(kModel, kProblem, clamped, learning::Vartype::spin, {}, penalty).sidecar;
    CHECK(read_sidecar(learning::sidecar_path(kProblem)).code_penalty == penalty);
    sample_problem(kProblem, kAnswer, *learning::make_sampler("exact"), {.reads = 40000, .seed = 11, .sweeps = 1});
    ImportRequest import = import_request();
    import.decoding = Decoding::discard;
    const Json answer = to_json(import_answer(import));
    double worst = 0;
    for (std::size_t y = 0; y < expected.size(); ++y) {
      const double error = std::sqrt(expected[y] * (1 - expected[y]) / answer.at("valid").number());
      const double found = answer.at("outcomes").at(contract().outcomes[y].name).at("frequency").number();
      worst = std::max(worst, std::abs(found - expected[y]) / error);
    }
    invalid.push_back(answer.at("invalid_share").number());
    std::printf("penalty %.0f: %.4f of the rows invalid, largest z %.2f\n", penalty, invalid.back(), worst);
    CHECK(worst < 4);
  }
  CHECK(invalid[0] > 0.5);
  // Every invalid row weighs exp(-penalty) of what it did, or less.
  for (std::size_t k : {1, 2}) {
    const double odds = invalid[0] / (1 - invalid[0]) * std::exp(-3.0 * double(k));
    CHECK(invalid[k] > 0);
    CHECK(invalid[k] / (1 - invalid[k]) < 1.1 * odds);
  }
  refused([&] { export_problem(kModel, kProblem, clamped, learning::Vartype::binary, {}, -1); }, "at least 0");
  refused([&] { sample_problem(kProblem, kAnswer, *learning::make_sampler("block_gibbs"), {.reads = 10}); },
          "tempering");
  replace_in_file(learning::sidecar_path(kProblem), "\"code_penalty\": 6.0", "\"code_penalty\": -6.0");
  refused([] { read_sidecar(learning::sidecar_path(kProblem)); }, "code_penalty");
}

TEST_CASE("repair keeps rows whose thermometer codes have gaps and reports how many") {
  const TrainingData data = make_training_data(synthetic_trials(60, 8), {});
  learning::Model model;
  model.layout = make_layout(data, {});
  model.weights = learning::RbmWeights::zeros(model.layout.unit_count(), 1);
  model.sampled_lower = data.lower;
  model.sampled_upper = data.upper;
  learning::write_model(kModel, model);
  const Sidecar sidecar = export_problem(kModel, kProblem, {}, learning::Vartype::binary).sidecar;
  learning::SampleSet answer;
  answer.labels = sidecar.labels;
  answer.values.assign(3 * sidecar.labels.size(), 0);
  const std::size_t go = model.layout.input_unit_count(), width = sidecar.labels.size();
  answer.values[go] = answer.values[width + go] = 1;  // the last row has no outcome
  answer.values[width + 4] = 1;                       // slope_along: a lone one
  answer.energies = {0, 0, 0};
  answer.occurrences = {2, 3, 4};
  write_file_atomically(kAnswer, learning::to_dimod_json(answer));
  ImportRequest import = import_request();
  import.limits = {.reads = 1, .share = 0};
  import.decoding = Decoding::discard;
  const Json strict = to_json(import_answer(import));
  CHECK(strict.at("valid").number() == 2);
  CHECK(strict.at("repaired").number() == 0);
  import.decoding = Decoding::repair;
  const Json repaired = to_json(import_answer(import));
  CHECK(repaired.at("valid").number() == 2);
  CHECK(repaired.at("repaired").number() == 3);
  CHECK(repaired.at("reads").number() == 9);
  const learning::Encoder& slope = model.layout.encoders()[0];
  CHECK(repaired.at("variables").at("slope_along").at("mean").number() ==
        Approx((2 * slope.value(0) + 3 * slope.value(1)) / 5));
}

TEST_CASE("weighed rows give the machine's outcomes where code words are rare, and the import shows its own beside") {
  const learning::Model model = write_small_model();
  const std::map<std::string, double> clamped = {{"slope_along", 12}, {"friction_angle", 31}};
  const auto expected = own_probabilities(model, clamped);
  for (double penalty : {0.0, 6.0}) {
    const Exported exported = export_problem(kModel, kProblem, clamped, learning::Vartype::binary, {}, penalty);
    for (std::size_t y = 0; y < expected.size(); ++y)
      CHECK(exported.sidecar.machine_answer.at(contract().outcomes[y].name) == Approx(expected[y]).margin(1e-9));
    sample_problem(kProblem, kAnswer, *learning::make_sampler("exact"), {.reads = 4000, .seed = 11, .sweeps = 1});
    const Json answer = to_json(import_answer(import_request()));
    CHECK(answer.at("decoding").string() == "weigh");
    CHECK(largest_z(answer, expected) < 4);
    CHECK(answer.at("bias").at("verdict").string() == "none found");
    for (std::size_t y = 0; y < expected.size(); ++y)
      CHECK(answer.at("outcomes").at(contract().outcomes[y].name).at("machine").number() ==
            Approx(expected[y]).margin(1e-9));
    std::printf("penalty %.0f: %.1f %% code words, 4000 weighed reads worth %.0f, largest z %.2f\n", penalty,
                100 * (1 - answer.at("invalid_share").number()), answer.at("independent_reads").number(),
                largest_z(answer, expected));
    CHECK(answer.at("independent_reads").number() > 1000);
  }
}

TEST_CASE("rows of another temperature are refused, corrected where that is allowed, or named biased") {
  write_small_model();
  export_problem(kModel, kProblem, {{"slope_along", 12}}, learning::Vartype::binary);
  sample_problem(kProblem, kAnswer, *learning::make_sampler("anneal", {{"beta_end", 0.5}}),
                 {.reads = 4000, .seed = 1, .sweeps = 100});
  ImportRequest import = import_request();
  refused([&] { import_answer(import); }, "its rows have beta 0.");
  import.limits.temperature = 1;
  const Json corrected = to_json(import_answer(import));
  CHECK(corrected.at("temperature").at("verdict").string() == "corrected");
  CHECK(corrected.at("bias").at("verdict").string() == "none found");
  import.limits.temperature = INFINITY;
  const Json answer = to_json(import_answer(import));
  CHECK(answer.at("temperature").at("verdict").string() == "wrong");
  CHECK(answer.at("bias").at("verdict").string() == "biased");
  CHECK(std::abs(answer.at("bias").at("difference_in_errors").number()) > 4);
}

TEST_CASE("rows of a search for low energies are no answer, and train no model") {
  write_small_model();
  export_problem(kModel, kProblem, {{"slope_along", 12}}, learning::Vartype::binary);
  for (const std::size_t sweeps : {0, 20, 2000}) {
    CHECK(
        sample_problem(kProblem, kAnswer, *learning::make_sampler("tabu"), {.reads = 500, .sweeps = sweeps}).is_search);
    refused([&] { import_answer(import_request()); }, "follow no distribution; sample the problem with tempering");
  }
  for (const char* key : {"sampler", "stand_in"})
    refused([&] { read_learning_settings(Config::parse(std::string("{\"") + key + "\": \"tabu\"}", "study.json")); },
            "block_gibbs");
}

TEST_CASE("errors count reads that follow one another, and no error is zero") {
  const learning::Model model = write_small_model();
  const std::map<std::string, double> clamped = {{"slope_along", 12}, {"friction_angle", 31}};
  export_problem(kModel, kProblem, clamped, learning::Vartype::binary, {}, 6.0);
  sample_problem(kProblem, kAnswer, *learning::make_sampler("exact"), {.reads = 400, .seed = 5, .sweeps = 1});
  for (Decoding decoding : {Decoding::weigh, Decoding::discard}) {
    ImportRequest import = import_request();
    import.decoding = decoding;
    import.limits.temperature = INFINITY;  // rows that are repeated seem to tell beta better than they do
    const Json once = to_json(import_answer(import));
    learning::SampleSet rows = learning::samples_from_dimod_json(read_file(kAnswer), "answer");
    learning::SampleSet repeated = rows;  // every row eight times over, as a chain that moves at every eighth sweep
    repeated.values.clear();
    repeated.energies.clear();
    for (std::size_t r = 0; r < rows.row_count(); ++r)
      for (int copy = 0; copy < 8; ++copy) {
        repeated.values.insert(repeated.values.end(), rows.row(r).begin(), rows.row(r).end());
        repeated.energies.push_back(rows.energies[r]);
      }
    repeated.occurrences.assign(repeated.energies.size(), 1);
    write_file_atomically(kFolder / "repeated.json", learning::to_dimod_json(repeated));
    import.answer = kFolder / "repeated.json";
    const Json slow = to_json(import_answer(import));
    for (const auto& [name, entry] : once.at("outcomes").members()) {
      const Json& other = slow.at("outcomes").at(name);
      INFO(name);
      CHECK(entry.at("standard_error").number() > 0);
      CHECK(other.at("frequency").number() == Approx(entry.at("frequency").number()).margin(1e-9));
      if (entry.at("frequency").number() < 0.05) continue;
      CHECK(other.at("standard_error").number() > 0.7 * entry.at("standard_error").number());
      CHECK(other.at("standard_error").number() < 1.5 * entry.at("standard_error").number());
      CHECK(other.at("correlation_time").number() > 4);
    }
  }
}

TEST_CASE("answers with few code words are refused") {
  const learning::Model model = write_small_model();
  export_problem(kModel, kProblem, {}, learning::Vartype::binary, {}, 0.0);
  sample_problem(kProblem, kAnswer, *learning::make_sampler("block_gibbs"), {.reads = 200, .seed = 3, .sweeps = 20});
  ImportRequest import = import_request();
  import.decoding = Decoding::discard;
  refused([&] { import_answer(import); }, "an answer needs at least 100 and 5 %");
  import.limits = {.reads = 1, .share = 0};
  CHECK_NOTHROW(import_answer(import));
  import.decoding = Decoding::weigh;
  import.limits = {.reads = 500, .share = 0};
  refused([&] { import_answer(import); }, "independent");

  learning::SampleSet empty = learning::samples_from_dimod_json(read_file(kAnswer), "answer");
  empty.values.clear();
  empty.energies.clear();
  empty.occurrences.clear();
  write_file_atomically(kAnswer, learning::to_dimod_json(empty));
  refused([] { import_answer(import_request()); }, "no rows");
}

TEST_CASE("the corrected emulator answers a clamped question about the machine, on its own chains and on given ones") {
  const learning::Model model = write_small_model();
  const std::map<std::string, double> clamped = {{"slope_along", 12}, {"friction_angle", 31}};
  const auto expected = own_probabilities(model, clamped);
  export_problem(kModel, kProblem, clamped, learning::Vartype::binary);
  EmbedRequest request;
  request.problem = kProblem;
  request.out = kFolder / "qubits.json";
  request.graph.dead_share = 0.02;
  request.gauge = 5;
  embed_problem_file(request);
  DeviceChoice device;
  device.graph.dead_share = 0.02;
  for (const fs::path& problem : {kProblem, request.out}) {
    const SampleReport sampled =
        sample_emulated(problem, kAnswer, device, {.reads = 1000, .seed = 7, .sweeps = 200}, FileChoice{});
    REQUIRE(sampled.correction);
    CHECK(sampled.correction->beta == Approx(1).margin(0.1));
    ImportRequest import = import_request();
    import.problem = problem;
    const Json answer = to_json(import_answer(import));
    double worst = 0;
    for (std::size_t y = 0; y < expected.size(); ++y)
      worst = std::max(worst, std::abs(answer.at("outcomes").at(contract().outcomes[y].name).at("frequency").number() -
                                       expected[y]));
    std::printf("emulator: largest difference of an outcome %.3f, beta %.3f, chains broken %.4f\n", worst,
                sampled.correction->beta, sampled.correction->use.chain_break_fraction);
    CHECK(worst < 0.05);
  }
}

TEST_CASE("answers and sidecars of other problems are refused") {
  const learning::Model model = write_small_model();
  export_problem(kModel, kProblem, {}, learning::Vartype::binary);
  sample_problem(kProblem, kAnswer, *learning::make_sampler("block_gibbs"), {.reads = 10, .seed = 1, .sweeps = 5});
  const auto import = [] {
    ImportRequest request = import_request();
    request.limits = {.reads = 1, .share = 0};
    import_answer(request);
  };
  CHECK_NOTHROW(import());
  SECTION("clamped afterwards: other labels") {
    export_problem(kModel, kProblem, {{"slope_along", 12}}, learning::Vartype::binary);
    refused(import, "another problem");
  }
  SECTION("same labels, other numbers") {
    learning::Model other = model;
    other.weights.weight[3] += 0.5;
    learning::write_model(kModel, other);
    export_problem(kModel, kProblem, {}, learning::Vartype::binary);
    refused(import, "another problem");
    replace_in_file(kAnswer, "problem_hash", "problem_hush");  // even when the answer does not say whose it is
    refused(import, "energy");
  }
  SECTION("problem changed after the export") {
    replace_in_file(kProblem, "\"offset\":0.0", "\"offset\":1.0");
    refused(import, "sidecar");
  }
  SECTION("sidecar missing or damaged") {
    replace_in_file(learning::sidecar_path(kProblem), "\"beta\": 1.0", "\"beta\": -1.0");
    refused(import, "beta");
    fs::remove(learning::sidecar_path(kProblem));
    refused(import, "sidecar");
  }
  SECTION("another model") {
    learning::Model other = model;
    other.weights.weight[3] += 0.5;
    learning::write_model(kFolder / "other.h5", other);
    refused(
        [] {
          ImportRequest of_other = import_request();
          of_other.model = kFolder / "other.h5";
          import_answer(of_other);
        },
        "other.h5");
  }
  SECTION("cut off") {
    const std::string text = read_file(kAnswer);
    write_file_atomically(kAnswer, text.substr(0, text.size() / 2));
    refused(import, "answer.json");
  }
}

TEST_CASE("an embedded machine's answer gives the machine's outcomes, through gauge, scale, format and chains") {
  const learning::Model model = write_small_model();
  const std::map<std::string, double> clamped = {{"slope_along", 12}, {"friction_angle", 31}, {"cohesion", 4}};
  export_problem(kModel, kProblem, clamped, learning::Vartype::binary);
  EmbedRequest request;
  request.problem = kProblem;
  request.out = kFolder / "qubits.qubo";
  request.graph.name = "chimera:6";
  request.graph.dead_share = 0.02;
  request.gauge = 5;
  request.chain_strength = 3;
  const EmbedResult embedded = embed_problem_file(request);
  CHECK(embedded.masked == 0);
  CHECK(embedded.longest_chain > 1);
  CHECK(embedded.exported.sidecar.gauge.size() == embedded.qubits);
  sample_problem(request.out, kAnswer, *learning::make_sampler("tempering"), {.reads = 3000, .seed = 3, .sweeps = 300});
  ImportRequest import = import_request();
  import.problem = request.out;
  import.decoding = Decoding::discard;
  import.chains = "discard";  // rows without broken chains follow the machine's distribution exactly
  const Json answer = to_json(import_answer(import));
  const auto expected = learning::Posterior(model.layout, model.weights).marginal(to_variables(clamped)).probability;
  double worst = 0;
  for (std::size_t y = 0; y < expected.size(); ++y) {
    const double error = std::sqrt(expected[y] * (1 - expected[y]) / answer.at("valid").number());
    const double found = answer.at("outcomes").at(contract().outcomes[y].name).at("frequency").number();
    worst = std::max(worst, std::abs(found - expected[y]) / error);
  }
  const double broken = answer.at("chains").at("chain_break_fraction").number();
  std::printf("embedded: %zu variables on %zu qubits, longest chain %zu; %.1f %% of chains broken; largest z %.2f\n",
              embedded.variables, embedded.qubits, embedded.longest_chain, 100 * broken, worst);
  CHECK(answer.at("valid").number() > 300);
  CHECK(worst < 4);
  CHECK(broken > 0);
  import.chains = "guess";
  refused([&] { import_answer(import); }, "majority_vote");
}

TEST_CASE("an annealer's answer on the qubits of another graph is refused") {
  write_small_model();
  export_problem(kModel, kProblem, {{"slope_along", 12}}, learning::Vartype::binary);
  EmbedRequest request;
  request.problem = kProblem;
  const auto embed_on = [&](const std::string& graph, const std::string& name) {
    request.graph.name = graph;
    request.out = kFolder / name;
    embed_problem_file(request);
    return request.out;
  };
  const fs::path pegasus = embed_on("pegasus:4", "pegasus.json"), zephyr = embed_on("zephyr:4", "zephyr.json");
  DeviceChoice device;
  device.graph.name = "zephyr:4";
  const learning::SampleRequest few = {.reads = 20, .seed = 1, .sweeps = 50};
  refused([&] { sample_emulated(pegasus, kAnswer, device, few, FileChoice{}); },
          "embedded on another graph than zephyr:4");
  sample_emulated(zephyr, kAnswer, device, few, FileChoice{});
  ImportRequest import = import_request();
  import.problem = pegasus;
  refused([&] { import_answer(import); }, "another problem");
  replace_in_file(kAnswer, "problem_hash", "problem_hush");  // a machine's answer does not say whose it is
  refused([&] { import_answer(import); }, "give the answer to this very problem");
}

TEST_CASE("values on the command line are checked against the contract") {
  CHECK(parse_named_values({"slope_along=-12.5", "cohesion=3"}).at("slope_along") == -12.5);
  refused([] { parse_named_values({"slope_along"}); }, "variable=number");
  refused([] { parse_named_values({"slope_along=steep"}); }, "variable=number");
  refused([] { parse_named_values({"slope_along=12deg"}); }, "variable=number");
  refused([] { parse_named_values({"=12"}); }, "variable=number");
  refused([] { parse_named_values({""}); }, "variable=number");
  refused([] { parse_named_values({"slope_alonh=12"}); }, "slope_along");
  refused([] { parse_named_values({"slope=12"}); }, "did you mean \"slope_along\"");
  refused([] { parse_named_values({"slope_along=nan"}); }, "allowed range");
  refused([] { parse_named_values({"slope_along=80"}); }, "allowed range");
  refused([] { parse_named_values({"slope_along=1", "slope_along=2"}); }, "twice");
}
