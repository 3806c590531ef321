#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/app/cli/command.h"
#include "pipeline/learn/answer/named_values.h"
#include "pipeline/learn/qubo/qubo_embed.h"
#include "pipeline/learn/qubo/qubo_exchange.h"

namespace gonogo::app {
namespace {

struct Options {
  std::string model, problem, answer, out, rows, sampler = "block_gibbs", decode = "discard";
  std::string answer_format = "dimod_json";
  learn::FileChoice in, to;
  learning::SamplerSettings sampling;
  learn::DeviceChoice device;
  learn::EmbedRequest embed;
  double chain_strength = 0;
  std::uint64_t gauge = 0;
  std::string chains = "weighted_random";
  std::vector<std::string> clamp;
  double penalty = 0;
  bool spin = false;
  std::size_t reads = 1000, sweeps = 1000;
  std::uint64_t seed = 1;
};

using Shared = std::shared_ptr<Options>;

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (const learning::FormatFacts& format : learning::problem_formats()) names.emplace_back(format.name);
  return names;
}

/// Options of a file that is read.
void add_input_options(CLI::App* command, const Shared& options) {
  command->add_option("--from", options->in.format, "Format of the problem; default: its sidecar's, or by extension")
      ->type_name(one_of(format_names()));
  command->add_option("--solver", options->in.solver, "Solver definition (JSON) of a problem in sapi format")
      ->type_name(kFile);
  command->add_option("--vartype", options->in.vartype, "Variables of coordinate text that does not say")
      ->check(CLI::IsMember({"BINARY", "SPIN"}));
}

void print_export(const Globals& globals, const std::string& path, const learn::Exported& exported) {
  const learn::Sidecar& sidecar = exported.sidecar;
  Json json;
  json["problem"] = path;
  json["sidecar"] = learning::sidecar_path(path).string();
  json["problem_hash"] = sidecar.problem_hash;
  json["format"] = learning::facts(sidecar.format).name;
  json["variables"] = Json(std::uint64_t(sidecar.labels.size()));
  json["vartype"] = learning::vartype_name(sidecar.vartype);
  json["notes"] = Json(exported.notes);
  std::string text = path + ": " + std::to_string(sidecar.labels.size()) + " variables, " +
                     learning::vartype_name(sidecar.vartype) + ", " + learning::facts(sidecar.format).about +
                     "; sidecar " + learning::sidecar_path(path).string() + "\n";
  for (const std::string& note : exported.notes) text += "note: " + note + "\n";
  print_result(globals, json, text);
}

void add_export(CLI::App& qubo, const Shared& options, const Globals& globals) {
  CLI::App* command = qubo.add_subcommand("export", "Write a model's machine as an annealing problem, with a sidecar");
  command->add_option("--model", options->model, "Model file")->type_name(kFile)->required();
  command->add_option("--out", options->out, "Problem file to write; the sidecar goes beside it")
      ->type_name(kFile)
      ->required();
  command->add_option("--clamp", options->clamp, "Fix this variable at its value; may be repeated")
      ->type_name(kSetting);
  command
      ->add_option("--penalty", options->penalty,
                   "Energy, at least, of units that are no code word; code words keep their energies. Couples visible "
                   "units: sample with anneal, tempering, population or exact")
      ->capture_default_str();
  command->add_option("--format", options->to.format, "Format to write; default: by extension, .json being dimod_json")
      ->type_name(one_of(format_names()));
  command->add_flag("--spin", options->spin, "Ising form (SPIN) instead of QUBO (BINARY)");
  add_examples(*command, {"gonogo qubo export --model out/demo/model.h5 --out problem.json --clamp slope_along=12"});
  command->callback([options, &globals] {
    const auto vartype = options->spin ? learning::Vartype::spin : learning::Vartype::binary;
    print_export(globals, options->out,
                 learn::export_problem(options->model, options->out, learn::parse_named_values(options->clamp), vartype,
                                       options->to, options->penalty));
  });
}

void add_convert(CLI::App& qubo, const Shared& options, const Globals& globals) {
  CLI::App* command = qubo.add_subcommand("convert", "Write a problem in another format, with a sidecar");
  command->add_option("problem", options->problem, "Problem to read")->type_name(kFile)->required();
  add_input_options(command, options);
  command->add_option("--to", options->to.format, "Format to write; default: by extension")
      ->type_name(one_of(format_names()));
  command->add_option("--to-solver", options->to.solver, "Solver definition (JSON) to write sapi for")
      ->type_name(kFile);
  command->add_option("--out", options->out, "File to write; the sidecar goes beside it")->type_name(kFile)->required();
  add_examples(*command, {"gonogo qubo convert problem.json --to qbsolv --out problem.qubo"});
  command->callback([options, &globals] {
    print_export(globals, options->out,
                 learn::convert_problem(learn::load_problem(options->problem, options->in), options->out, options->to));
  });
}

void add_sampler_options(CLI::App* command, const Shared& options) {
  learning::SamplerSettings& settings = options->sampling;
  command->add_option("--beta-start", settings.beta_start, "anneal, tempering: first inverse temperature")
      ->capture_default_str();
  command->add_option("--beta", settings.beta_end, "anneal, tempering, population: rows follow exp(-beta E)")
      ->capture_default_str();
  command->add_option("--replicas", settings.replicas, "tempering: temperatures")->capture_default_str();
  command->add_option("--temperatures", settings.temperatures, "population: steps")->capture_default_str();
  command->add_option("--folder", settings.folder, "file: where problems are put and answers are found")
      ->type_name(kFolder);
  command->add_option("--time-limit", settings.time_limit_s, "command: seconds")->capture_default_str();
  command->add_option("program", settings.command,
                      "command: after --, program and arguments, no shell; {problem}, {answer}, {reads}, {seed} are "
                      "filled in");
  command->add_option("--temperature", options->device.temperature, "emulator: effective temperature")
      ->capture_default_str();
  command->add_option("--dead-share", options->device.graph.dead_share, "emulator: share of dead qubits")
      ->check(CLI::Range(0.0, 0.5))
      ->capture_default_str();
  command
      ->add_option("--dead-seed", options->device.graph.dead_seed,
                   "emulator: seed of the dead qubits; also the device's serial")
      ->capture_default_str();
}

void add_embed(CLI::App& qubo, const Shared& options, const Globals& globals) {
  CLI::App* command = qubo.add_subcommand("embed", "Lay a problem onto the qubits of a machine");
  learn::EmbedRequest& embed = options->embed;
  command->add_option("problem", options->problem, "Problem to read")->type_name(kFile)->required();
  add_input_options(command, options);
  command->add_option("--graph", embed.graph.name, "Graph: chimera:M, chimera:MxN, pegasus:M or zephyr:M")
      ->type_name("GRAPH")
      ->capture_default_str();
  command->add_option("--on-solver", embed.graph.solver, "Solver definition (JSON) with its working graph instead")
      ->type_name(kFile);
  command->add_option("--dead-share", embed.graph.dead_share, "Share of dead qubits of --graph")
      ->check(CLI::Range(0.0, 0.5))
      ->capture_default_str();
  command->add_option("--dead-seed", embed.graph.dead_seed, "Seed of the choice of dead qubits")->capture_default_str();
  command->add_option("--method", embed.method, "Method of embedding")
      ->type_name(one_of({"auto", "biclique", "clique", "heuristic"}))
      ->capture_default_str();
  CLI::Option* strength = command->add_option("--chain-strength", options->chain_strength,
                                              "Default: torque compensation, 1.414 rms(J) sqrt(mean degree)");
  CLI::Option* gauge = command->add_option("--gauge", options->gauge, "Seed of a random gauge; default: none");
  command->add_flag("--auto-scale", embed.auto_scale, "Scale to the full range; the sidecar keeps the factor");
  command->add_option("--seed", embed.seed, "Seed of the heuristic")->capture_default_str();
  command->add_option("--to", options->to.format, "Format to write; default: by extension")
      ->type_name(one_of(format_names()));
  command->add_option("--out", options->out, "File to write; the sidecar goes beside it")->type_name(kFile)->required();
  add_examples(*command, {"gonogo qubo embed problem.json --graph pegasus:16 --out qubits.json"});
  command->callback([options, strength, gauge, &globals] {
    learn::EmbedRequest request = options->embed;
    request.problem = options->problem;
    request.out = options->out;
    request.from = options->in;
    request.to = options->to;
    request.to.solver = request.graph.solver;
    if (strength->count() > 0) request.chain_strength = options->chain_strength;
    if (gauge->count() > 0) request.gauge = options->gauge;
    const learn::EmbedResult result = learn::embed_problem_file(request);
    char text[200];
    std::snprintf(text, sizeof text, "%zu variables on %zu qubits, longest chain %zu, chain strength %.6g, scale %.6g",
                  result.variables, result.qubits, result.longest_chain, result.chain_strength, result.scale);
    learn::Exported exported = result.exported;
    exported.notes.insert(exported.notes.begin(), text);
    print_export(globals, options->out, exported);
  });
}

void add_sample(CLI::App& qubo, const Shared& options, const Globals& globals) {
  CLI::App* command = qubo.add_subcommand("sample", "Draw rows of a problem from P(x) proportional to exp(-E(x))");
  command->add_option("problem", options->problem, "Problem in dimod's JSON")->type_name(kFile)->required();
  command->add_option("--sampler", options->sampler, "Sampler; emulator stands for a D-Wave 2X")
      ->type_name(one_of({"block_gibbs", "anneal", "tempering", "population", "exact", "file", "command", "emulator"}))
      ->capture_default_str();
  add_input_options(command, options);
  add_sampler_options(command, options);
  command->add_flag("--gpu", options->sampling.on_gpu, "Sampler block_gibbs: on a GPU, with weights of 16 bits");
  command->add_option("--reads", options->reads, "Rows")->check(CLI::Range(1, 100000000))->capture_default_str();
  command->add_option("--sweeps", options->sweeps, "Sweeps of every chain")
      ->check(CLI::Range(1, 1000000000))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Seed")->capture_default_str();
  command->add_option("--out", options->out, "Answer file to write")->type_name(kFile)->required();
  add_examples(*command,
               {"gonogo qubo sample problem.json --sampler block_gibbs --reads 1000 --seed 7 --out answer.json",
                "gonogo qubo sample problem.json --sampler command --out answer.json -- \\\n"
                "      python3 scripts/ocean_bridge.py {problem} {answer} --reads {reads} --sampler annealer"});
  command->callback([options, &globals] {
    const auto sampler = learn::make_any_sampler(options->sampler, options->sampling, options->device);
    learning::SampleRequest request;
    request.reads = options->reads;
    request.sweeps = options->sweeps;
    request.seed = options->seed;
    const Json json = learn::sample_problem(options->problem, options->out, *sampler, request, options->in);
    char text[200];
    std::snprintf(text, sizeof text, ": %zu rows, mean energy %.6g, lowest %.6g\n", options->reads,
                  json.at("energy_mean").number(), json.at("energy_lowest").number());
    print_result(globals, json, options->out + text);
  });
}

std::string chains_text(const Json& json) {
  const Json* chains = json.find("chains");
  if (!chains) return "";
  char line[80];
  std::snprintf(line, sizeof line, "%.2f %% of the chains were broken\n",
                100 * chains->at("chain_break_fraction").number());
  return line;
}

std::string import_text(const Json& json) {
  char line[200];
  if (!json.find("outcomes")) {
    std::snprintf(line, sizeof line, "%.0f reads, energies verified\n", json.at("reads").number());
    return line + chains_text(json);
  }
  std::snprintf(line, sizeof line, "%.0f reads, energies verified; %.1f %% hold code words only, %.0f repaired\n",
                json.at("reads").number(), 100 * (1 - json.at("invalid_share").number()), json.at("repaired").number());
  std::string text = line + chains_text(json);
  for (const auto& [name, entry] : json.at("outcomes").members()) {
    std::snprintf(line, sizeof line, "%-24s %.4f +- %.4f\n", name.c_str(), entry.at("frequency").number(),
                  entry.at("standard_error").number());
    text += line;
  }
  for (const auto& [name, entry] : json.at("variables").members()) {
    std::snprintf(line, sizeof line, "%-24s %.4g, standard deviation %.4g %s\n", name.c_str(),
                  entry.at("mean").number(), entry.at("standard_deviation").number(),
                  entry.at("unit").string().c_str());
    text += line;
  }
  return text;
}

void add_import(CLI::App& qubo, const Shared& options, const Globals& globals) {
  CLI::App* command =
      qubo.add_subcommand("import", "Read an answer back: verify it, decode rows to variables and outcomes");
  command->add_option("--problem", options->problem, "Problem that was exported, with its sidecar beside it")
      ->type_name(kFile)
      ->required();
  command->add_option("--answer", options->answer, "Answer file")->type_name(kFile)->required();
  std::string formats = learning::answer_format_names();
  formats.erase(std::remove(formats.begin(), formats.end(), ' '), formats.end());
  command->add_option("--answer-format", options->answer_format, "Format of the answer")
      ->type_name("{" + formats + "}")
      ->capture_default_str();
  add_input_options(command, options);
  command->add_option("--chains", options->chains, "How broken chains of an embedded problem are read")
      ->type_name(one_of({"weighted_random", "majority_vote", "discard", "minimize_energy"}))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Seed of weighted_random")->capture_default_str();
  command->add_option("--model", options->model, "Also check that the problem was exported from this model")
      ->type_name(kFile);
  command->add_option("--rows", options->rows, "Write the decoded rows as CSV")->type_name(kFile);
  command->add_option("--decode", options->decode, "Rows that are no code word: discard, or repair where a rule exists")
      ->check(CLI::IsMember({"discard", "repair"}))
      ->capture_default_str();
  add_examples(*command, {"gonogo qubo import --problem problem.json --answer answer.json --rows rows.csv"});
  command->callback([options, &globals] {
    learn::ImportRequest request;
    request.problem = options->problem;
    request.answer = options->answer;
    request.problem_file = options->in;
    request.answer_format = options->answer_format;
    request.model = options->model;
    request.rows = options->rows;
    request.chains = options->chains;
    request.seed = options->seed;
    if (options->decode == "repair") request.rule = learning::DecodeRule::repair;
    const Json json = learn::import_answer(request);
    print_result(globals, json, import_text(json));
  });
}

}  // namespace

void add_qubo_command(CLI::App& app, const Globals& globals) {
  CLI::App* qubo =
      app.add_subcommand("qubo", "Annealing problems: export from a model, convert, sample, import answers");
  qubo->require_subcommand(1);
  add_examples(*qubo, {"gonogo qubo export --model out/demo/model.h5 --out problem.json",
                       "gonogo qubo sample problem.json --reads 1000 --out answer.json",
                       "gonogo qubo import --problem problem.json --answer answer.json"});
  const Shared options = std::make_shared<Options>();
  add_export(*qubo, options, globals);
  add_convert(*qubo, options, globals);
  add_embed(*qubo, options, globals);
  add_sample(*qubo, options, globals);
  add_import(*qubo, options, globals);
}

}  // namespace gonogo::app
