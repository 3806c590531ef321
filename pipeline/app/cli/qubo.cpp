#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/app/cli/qubo_options.h"
#include "pipeline/learn/answer/named_values.h"
#include "pipeline/map/model/trained_model.h"

namespace gonogo::app {
namespace {

void add_export(CLI::App& qubo, const SharedQubo& options, const Globals& globals) {
  CLI::App* command = qubo.add_subcommand("export", "Write a model's machine as an annealing problem, with a sidecar");
  command->add_option("--model", options->model, "Model file, or name of one that ships")
      ->type_name(kModel)
      ->required();
  command->add_option("--out", options->out, "Problem file to write; the sidecar goes beside it")
      ->type_name(kFile)
      ->required();
  command->add_option("--clamp", options->clamp, "Fix this variable at its value; may be repeated")
      ->type_name(kSetting);
  CLI::Option* penalty = command->add_option(
      "--penalty", options->penalty,
      "Energy, at least, of units that are no code word; code words keep their energies. Couples visible units: sample "
      "with anneal, tempering, population or exact. Default: none where import can weigh code words, otherwise 8");
  command->add_option("--format", options->to.format, "Format to write; default: by extension, .json being dimod_json")
      ->type_name(one_of(format_names()));
  command->add_flag("--spin", options->spin, "Ising form (SPIN) instead of QUBO (BINARY)");
  add_examples(*command, {"gonogo qubo export --model quarter_wheel_90mm --out problem.json --clamp slope_along=12"});
  command->callback([options, penalty, &globals] {
    options->to.option = "--format";
    const auto vartype = options->spin ? learning::Vartype::spin : learning::Vartype::binary;
    print_export(globals, options->out,
                 learn::export_problem(map::find_model(options->model), options->out,
                                       learn::parse_named_values(options->clamp), vartype, options->to,
                                       penalty->count() > 0 ? std::optional(options->penalty) : std::nullopt));
  });
}

void add_convert(CLI::App& qubo, const SharedQubo& options, const Globals& globals) {
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
    options->to.option = "--to";
    print_export(globals, options->out,
                 learn::convert_problem(learn::load_problem(options->problem, options->in), options->out, options->to));
  });
}

void add_sampler_options(CLI::App* command, const SharedQubo& options) {
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
  command->add_option("--graph", options->device.graph.name, "emulator: its graph, as for gonogo qubo embed")
      ->type_name("GRAPH")
      ->capture_default_str();
  command
      ->add_option("--post-sweeps", options->device.post_sweeps,
                   "emulator: sweeps of block Gibbs on the host, from the device's rows")
      ->check(CLI::Range(0, 1000000))
      ->capture_default_str();
  command->add_flag("--as-programmed", options->device.as_programmed,
                    "emulator: correct nothing; the problem must be on its qubits");
  command->add_option("--dead-share", options->device.graph.dead_share, "emulator: share of dead qubits")
      ->check(CLI::Range(0.0, 0.5))
      ->capture_default_str();
  command
      ->add_option("--dead-seed", options->device.graph.dead_seed,
                   "emulator: seed of the dead qubits; also the device's serial")
      ->check(kSeed)
      ->capture_default_str();
}

void add_embed(CLI::App& qubo, const SharedQubo& options, const Globals& globals) {
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
  command->add_option("--dead-seed", embed.graph.dead_seed, "Seed of the choice of dead qubits")
      ->check(kSeed)
      ->capture_default_str();
  command->add_option("--method", embed.method, "Method of embedding")
      ->type_name(one_of({"auto", "biclique", "clique", "heuristic"}))
      ->capture_default_str();
  CLI::Option* strength = command->add_option("--chain-strength", options->chain_strength,
                                              "Default: torque compensation, 1.414 rms(J) sqrt(mean degree)");
  CLI::Option* gauge =
      command->add_option("--gauge", options->gauge, "Seed of a random gauge; default: none")->check(kSeed);
  command->add_flag("--auto-scale", embed.auto_scale, "Scale to the full range; the sidecar keeps the factor");
  command->add_option("--seed", embed.seed, "Seed of the heuristic")->check(kSeed)->capture_default_str();
  command->add_option("--time-limit", embed.time_limit_s, "Of the heuristic [s]")
      ->check(CLI::Range(0.1, 1e6))
      ->capture_default_str();
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
    request.to.option = "--to";
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

/// What the corrected emulator set, and what it left.
std::string correction_text(const Json& json) {
  const Json* correction = json.find("correction");
  if (!correction) return "";
  const auto number = [&](const char* key) { return correction->at(key).number(); };
  char text[400];
  std::snprintf(text, sizeof text,
                "corrected: scale %.3g, chains of strength %.2g, %.0f programmings in random gauges\n"
                "left: beta of the rows %.3f (95 %% interval %.3f to %.3f, 1 is right), %.2f %% of the chains broken, "
                "%.0f coefficients cut to the range, %.0f pairs masked; then %.0f sweeps of block Gibbs on the host\n",
                number("scale"), number("chain_coupling"), number("programmings"), number("beta"), number("beta_low"),
                number("beta_high"), 100 * number("chain_break_fraction"), number("cut_coefficients"),
                number("masked_pairs"), number("post_sweeps"));
  return text;
}

void add_sample(CLI::App& qubo, const SharedQubo& options, const Globals& globals) {
  CLI::App* command = qubo.add_subcommand("sample", "Draw rows of a problem from P(x) proportional to exp(-E(x))");
  command->add_option("problem", options->problem, "Problem in dimod's JSON")->type_name(kFile)->required();
  command
      ->add_option("--sampler", options->sampler,
                   "Sampler; emulator stands for a D-Wave 2X, corrected for scale, "
                   "temperature, chains and gauges")
      ->type_name(one_of({"block_gibbs", "anneal", "tempering", "population", "exact", "file", "command", "emulator"}))
      ->capture_default_str();
  add_input_options(command, options);
  add_sampler_options(command, options);
  command->add_flag("--gpu", options->sampling.on_gpu, "Sampler block_gibbs: on a GPU, with weights of 16 bits");
  command->add_option("--reads", options->reads, "Rows")->check(CLI::Range(1, 100000000))->capture_default_str();
  command->add_option("--sweeps", options->sweeps, "Sweeps of every chain")
      ->check(CLI::Range(1, 1000000000))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Seed")->check(kSeed)->capture_default_str();
  command->add_option("--out", options->out, "Answer file to write")->type_name(kFile)->required();
  add_examples(*command,
               {"gonogo qubo sample problem.json --sampler block_gibbs --reads 1000 --seed 7 --out answer.json",
                "gonogo qubo sample problem.json --sampler command --out answer.json -- \\\n"
                "      python3 scripts/ocean_bridge.py {problem} {answer} --reads {reads} --sampler annealer"});
  command->callback([options, &globals] {
    learning::SampleRequest request;
    request.reads = options->reads;
    request.sweeps = options->sweeps;
    request.seed = options->seed;
    const Json json =
        options->sampler == "emulator"
            ? learn::sample_emulated(options->problem, options->out, options->device, request, options->in)
            : learn::sample_problem(options->problem, options->out,
                                    *learning::make_sampler(options->sampler, options->sampling), request, options->in);
    char text[200];
    std::snprintf(text, sizeof text, ": %zu rows, mean energy %.6g, lowest %.6g\n", options->reads,
                  json.at("energy_mean").number(), json.at("energy_lowest").number());
    print_result(globals, json, options->out + text + correction_text(json));
  });
}

}  // namespace

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

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (const learning::FormatFacts& format : learning::problem_formats()) names.emplace_back(format.name);
  return names;
}

void add_input_options(CLI::App* command, const SharedQubo& options) {
  options->in.option = "--from";
  command->add_option("--from", options->in.format, "Format of the problem; default: its sidecar's, or by extension")
      ->type_name(one_of(format_names()));
  command->add_option("--solver", options->in.solver, "Solver definition (JSON) of a problem in sapi format")
      ->type_name(kFile);
  command->add_option("--vartype", options->in.vartype, "Variables of coordinate text that does not say")
      ->check(CLI::IsMember({"BINARY", "SPIN"}));
}

void add_qubo_command(CLI::App& app, const Globals& globals) {
  CLI::App* qubo =
      app.add_subcommand("qubo", "Annealing problems: export from a model, convert, sample, import answers");
  qubo->require_subcommand(1);
  add_examples(*qubo, {"gonogo qubo export --model quarter_wheel_90mm --clamp slope_along=12 --out problem.json",
                       "gonogo qubo sample problem.json --reads 1000 --out answer.json",
                       "gonogo qubo import --problem problem.json --answer answer.json"});
  const auto options = std::make_shared<QuboOptions>();
  add_export(*qubo, options, globals);
  add_convert(*qubo, options, globals);
  add_embed(*qubo, options, globals);
  add_sample(*qubo, options, globals);
  add_qubo_import(*qubo, options, globals);
  add_qubo_contact(*qubo, globals);
}

}  // namespace gonogo::app
