#include <algorithm>
#include <cctype>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/format.h"
#include "pipeline/app/learning/qubo_options.h"
#include "pipeline/map/trained_model.h"
#include "pipeline/outcome/answer/infer.h"

namespace gonogo::app {
namespace {

void add_export(CLI::App& qubo, const SharedQubo& options, const Globals& globals) {
  CLI::App* command = qubo.add_subcommand("export", "Write a model's machine as an annealing problem, with a sidecar");
  add_named(*command, "--model", options->model, kModel, "Model file, or name of one that ships")->required();
  add_named(*command, "--out", options->out, kFile, "Problem file to write; the sidecar goes beside it")->required();
  add_named(*command, "--clamp", options->clamp, kSetting, "Fix this variable at its value; may be repeated");
  CLI::Option* penalty = command->add_option(
      "--penalty", options->penalty,
      "Energy, at least, of units that are no code word; code words keep their energies. Couples visible units: sample "
      "with anneal, tempering, population or exact. Default: none, and free units where code words are rare");
  add_named(*command, "--format", options->to.format, one_of(format_names()),
            "Format to write; default: by extension, .json being dimod_json");
  command->add_flag("--spin", options->spin, "Ising form (SPIN) instead of QUBO (BINARY)");
  add_examples(*command, {"gonogo qubo export --model quarter_wheel_90mm --out problem.json --clamp slope_along=12"});
  command->callback([options, penalty, &globals] {
    options->to.option = "--format";
    const auto vartype = options->spin ? learning::Vartype::spin : learning::Vartype::binary;
    print_export(globals, options->out,
                 outcome::export_problem(map::find_model(options->model), options->out,
                                         outcome::parse_named_values(options->clamp), vartype, options->to,
                                         penalty->count() > 0 ? std::optional(options->penalty) : std::nullopt));
  });
}

void add_convert(CLI::App& qubo, const SharedQubo& options, const Globals& globals) {
  CLI::App* command = qubo.add_subcommand("convert", "Write a problem in another format, with a sidecar");
  add_named(*command, "problem", options->problem, kFile, "Problem to read")->required();
  add_input_options(command, options);
  add_named(*command, "--to", options->to.format, one_of(format_names()), "Format to write; default: by extension");
  add_named(*command, "--to-solver", options->to.solver, kFile, "Solver definition (JSON) to write sapi for");
  add_named(*command, "--out", options->out, kFile, "File to write; the sidecar goes beside it")->required();
  add_examples(*command, {"gonogo qubo convert problem.json --to qbsolv --out problem.qubo"});
  command->callback([options, &globals] {
    options->to.option = "--to";
    print_export(
        globals, options->out,
        outcome::convert_problem(outcome::load_problem(options->problem, options->in), options->out, options->to));
  });
}

using learning::SamplerSettings;

std::string upper(std::string text) {
  for (char& c : text) c = char(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

/// Adds an option whose value goes into `given` under the parameter's name; `names`: the samplers that have it.
/// `fallback`: the number that all of them take without it; none if they differ.
void add_setting(CLI::App* command, const learning::SamplerParameter& parameter, const std::string& names,
                 const std::string& fallback, SamplerSettings& given) {
  const std::string name = parameter.name, help = names + ": " + parameter.help;
  const auto keep = [&given, name](const auto& value) { given[name] = value; };
  if (std::holds_alternative<bool>(parameter.fallback)) {
    command->add_flag_callback(
        parameter.option, [keep] { keep(true); }, help);
  } else if (const auto* whole = std::get_if<std::int64_t>(&parameter.fallback)) {
    command->add_option_function<std::int64_t>(parameter.option, keep, help)
        ->type_name("UINT")
        ->default_str(std::to_string(*whole));
  } else if (std::holds_alternative<double>(parameter.fallback)) {
    command->add_option_function<double>(parameter.option, keep, help)->default_str(fallback);
  } else if (std::holds_alternative<std::string>(parameter.fallback)) {
    command->add_option_function<std::string>(parameter.option, keep, help)->type_name(upper(name));
  } else {
    command->add_option_function<std::vector<std::string>>(parameter.option, keep, help);
  }
}

/// An option for every parameter of the samplers; those of one name are one option.
void add_settings(CLI::App* command, SamplerSettings& given) {
  std::vector<const learning::SamplerParameter*> parameters;
  std::map<std::string, std::string> names, fallback;
  for (const learning::SamplerKind* kind : learning::samplers())
    for (const learning::SamplerParameter& parameter : kind->parameters) {
      std::string& list = names[parameter.name];
      if (list.empty()) parameters.push_back(&parameter);
      list += (list.empty() ? "" : ", ") + std::string(kind->name);
      const auto* number = std::get_if<double>(&parameter.fallback);
      const std::string text = number ? number_text(*number) : "";
      if (const auto [other, is_new] = fallback.try_emplace(parameter.name, text); !is_new && other->second != text)
        other->second = "";
    }
  for (const learning::SamplerParameter* parameter : parameters)
    add_setting(command, *parameter, names[parameter->name], fallback[parameter->name], given);
}

/// The sampler with those of the given settings that it has.
std::unique_ptr<learning::Sampler> chosen_sampler(const QuboOptions& options) {
  SamplerSettings own;
  for (const learning::SamplerParameter& parameter : learning::sampler_named(options.sampler).parameters)
    if (const auto given = options.sampling.find(parameter.name); given != options.sampling.end()) own.insert(*given);
  return outcome::sampler_for(options.problem, options.sampler, own, options.in);
}

/// Whether the program's answers are corrected: where a graph is given it is a machine on qubits.
bool is_machine(const CLI::App& command, const QuboOptions& options) {
  return options.sampler == "command" && !options.device.as_programmed &&
         (command.count("--graph") > 0 || command.count("--on-solver") > 0);
}

void add_sampler_options(CLI::App* command, const SharedQubo& options) {
  add_settings(command, options->sampling);
  command
      ->add_option("--temperature", options->device.temperature,
                   "emulator: effective temperature; machine: where the search for its scale begins")
      ->capture_default_str();
  add_named(*command, "--graph", options->device.graph.name, "GRAPH",
            "emulator: its graph, as for gonogo qubo embed; command: the program is a machine with this graph, whose "
            "answers are corrected as the emulator's")
      ->capture_default_str();
  add_named(*command, "--on-solver", options->device.graph.solver, kFile,
            "Solver definition (JSON) with graph and ranges in place of --graph");
  add_number(*command, "--post-sweeps", options->device.post_sweeps, {0, 1000000},
             "emulator, machine: sweeps of block Gibbs on the host, from the device's rows");
  command->add_flag("--as-programmed", options->device.as_programmed,
                    "emulator: correct nothing; the problem must be on its qubits");
  add_number(*command, "--dead-share", options->device.graph.dead_share, {0.0, 0.5}, "emulator: share of dead qubits");
  command
      ->add_option("--dead-seed", options->device.graph.dead_seed,
                   "emulator: seed of the dead qubits; also the device's serial")
      ->check(kSeed)
      ->capture_default_str();
}

void add_embed(CLI::App& qubo, const SharedQubo& options, const Globals& globals) {
  CLI::App* command = qubo.add_subcommand("embed", "Lay a problem onto the qubits of a machine");
  outcome::EmbedRequest& embed = options->embed;
  add_named(*command, "problem", options->problem, kFile, "Problem to read")->required();
  add_input_options(command, options);
  add_named(*command, "--graph", embed.graph.name, "GRAPH", "Graph: chimera:M, chimera:MxN, pegasus:M or zephyr:M")
      ->capture_default_str();
  add_named(*command, "--on-solver", embed.graph.solver, kFile,
            "Solver definition (JSON) with its working graph instead");
  add_number(*command, "--dead-share", embed.graph.dead_share, {0.0, 0.5}, "Share of dead qubits of --graph");
  command->add_option("--dead-seed", embed.graph.dead_seed, "Seed of the choice of dead qubits")
      ->check(kSeed)
      ->capture_default_str();
  add_named(*command, "--method", embed.method, one_of({"auto", "biclique", "clique", "heuristic"}),
            "Method of embedding")
      ->capture_default_str();
  CLI::Option* strength = command->add_option("--chain-strength", options->chain_strength,
                                              "Default: torque compensation, 1.414 rms(J) sqrt(mean degree)");
  CLI::Option* gauge =
      command->add_option("--gauge", options->gauge, "Seed of a random gauge; default: none")->check(kSeed);
  command->add_flag("--auto-scale", embed.auto_scale, "Scale to the full range; the sidecar keeps the factor");
  command->add_option("--seed", embed.seed, "Seed of the heuristic")->check(kSeed)->capture_default_str();
  add_number(*command, "--time-limit", embed.time_limit_s, {0.1, 1e6}, "Of the heuristic [s]");
  add_named(*command, "--to", options->to.format, one_of(format_names()), "Format to write; default: by extension");
  add_named(*command, "--out", options->out, kFile, "File to write; the sidecar goes beside it")->required();
  add_examples(*command, {"gonogo qubo embed problem.json --graph pegasus:16 --out qubits.json"});
  command->callback([options, strength, gauge, &globals] {
    outcome::EmbedRequest request = options->embed;
    request.problem = options->problem;
    request.out = options->out;
    request.from = options->in;
    request.to = options->to;
    request.to.option = "--to";
    request.to.solver = request.graph.solver;
    if (strength->count() > 0) request.chain_strength = options->chain_strength;
    if (gauge->count() > 0) request.gauge = options->gauge;
    const outcome::EmbedResult result = outcome::embed_problem_file(request);
    char text[200];
    std::snprintf(text, sizeof text, "%zu variables on %zu qubits, longest chain %zu, chain strength %.6g, scale %.6g",
                  result.variables, result.qubits, result.longest_chain, result.chain_strength, result.scale);
    outcome::Exported exported = result.exported;
    exported.notes.insert(exported.notes.begin(), text);
    print_export(globals, options->out, exported);
  });
}

/// What the corrected emulator set, and what it left.
std::string correction_text(const learning::Correction& left) {
  return line(
      "corrected: scale %.3g, chains of strength %.2g, %zu programmings in random gauges\n"
      "left: beta of the rows %.3f (95 %% interval %.3f to %.3f, 1 is right), %.2f %% of the chains broken, "
      "%zu coefficients cut to the range, %zu pairs masked; then %zu sweeps of block Gibbs on the host\n",
      left.use.scale, left.chain_coupling, left.programmings, left.beta, left.beta_low, left.beta_high,
      100 * left.use.chain_break_fraction, left.use.cut_coefficients, left.masked_pairs, left.post_sweeps);
}

void add_sample(CLI::App& qubo, const SharedQubo& options, const Globals& globals) {
  CLI::App* command = qubo.add_subcommand(
      "sample", "Draw rows of a problem from P(x) proportional to exp(-E(x)), or search for low energies");
  add_named(*command, "problem", options->problem, kFile, "Problem in dimod's JSON")->required();
  add_named(*command, "--sampler", options->sampler, one_of(learning::sampler_names_and_emulator()),
            "Sampler; emulator stands for a D-Wave 2X, corrected for scale, "
            "temperature, chains and gauges")
      ->capture_default_str();
  add_input_options(command, options);
  add_sampler_options(command, options);
  add_number(*command, "--reads", options->reads, {1, 100000000}, "Rows");
  add_number(*command, "--sweeps", options->sweeps, {1, 1000000000}, "Sweeps of every chain");
  command->add_option("--seed", options->seed, "Seed")->check(kSeed)->capture_default_str();
  add_named(*command, "--out", options->out, kFile, "Answer file to write")->required();
  add_examples(*command,
               {"gonogo qubo sample problem.json --sampler block_gibbs --reads 1000 --seed 7 --out answer.json",
                "gonogo qubo sample problem.json --sampler tabu --reads 20 --sweeps 20000 --out lowest.json",
                "gonogo qubo sample problem.json --sampler command --out answer.json -- \\\n"
                "      python3 scripts/ocean_bridge.py {problem} {answer} --reads {reads} --sampler annealer"});
  command->callback([options, command, &globals] {
    learning::SampleRequest request;
    request.reads = options->reads;
    request.sweeps = options->sweeps;
    request.seed = options->seed;
    if (is_machine(*command, *options)) options->device.machine = chosen_sampler(*options);
    const outcome::SampleReport report =
        options->sampler == learning::kEmulator || options->device.machine
            ? outcome::sample_emulated(options->problem, options->out, options->device, request, options->in)
            : outcome::sample_problem(options->problem, options->out, *chosen_sampler(*options), request, options->in);
    std::string text = options->out + line(": %zu rows, mean energy %.6g, lowest %.6g\n", options->reads,
                                           report.energy_mean, report.energy_lowest);
    if (!report.anneal.is_null())
      text += line("annealed from beta %.4g to %.4g, %s\n", report.anneal.at("beta_start").number(),
                   report.anneal.at("beta_end").number(), report.anneal.at("schedule").string().c_str());
    if (report.is_search) text += "rows of low energy, which follow no distribution: for optima, not for P(outcome)\n";
    if (report.correction) text += correction_text(*report.correction);
    print_result(globals, outcome::to_json(report), text);
  });
}

}  // namespace

void print_export(const Globals& globals, const std::string& path, const outcome::Exported& exported) {
  const outcome::Sidecar& sidecar = exported.sidecar;
  Json json;
  json["problem"] = path;
  json["sidecar"] = learning::sidecar_path(path).string();
  json["problem_hash"] = sidecar.problem_hash;
  json["format"] = sidecar.format->name;
  json["variables"] = Json(std::uint64_t(sidecar.labels.size()));
  json["vartype"] = learning::vartype_name(sidecar.vartype);
  json["notes"] = Json(exported.notes);
  std::string text = path + ": " + std::to_string(sidecar.labels.size()) + " variables, " +
                     learning::vartype_name(sidecar.vartype) + ", " + sidecar.format->about + "; sidecar " +
                     learning::sidecar_path(path).string() + "\n";
  for (const std::string& note : exported.notes) text += "note: " + note + "\n";
  print_result(globals, json, text);
}

std::vector<std::string> format_names() { return learning::names_of(learning::problem_formats()); }

void add_input_options(CLI::App* command, const SharedQubo& options) {
  options->in.option = "--from";
  add_named(*command, "--from", options->in.format, one_of(format_names()),
            "Format of the problem; default: its sidecar's, or by extension");
  add_named(*command, "--solver", options->in.solver, kFile, "Solver definition (JSON) of a problem in sapi format");
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
