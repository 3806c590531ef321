#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "pipeline/app/cli/qubo_options.h"

namespace gonogo::app {
namespace {

std::string chains_text(const Json& json) {
  const Json* chains = json.find("chains");
  if (!chains) return "";
  char line[80];
  std::snprintf(line, sizeof line, "%.2f %% of the chains were broken\n",
                100 * chains->at("chain_break_fraction").number());
  return line;
}

std::string formatted(const char* format, ...) {
  char line[300];
  va_list values;
  va_start(values, format);
  std::vsnprintf(line, sizeof line, format, values);
  va_end(values);
  return line;
}

/// How the rows were read, and what that did to the answer.
std::string decoding_text(const Json& json) {
  const std::string decoding = json.at("decoding").string();
  const double reads = json.at("reads").number(), valid = json.at("valid").number();
  std::string text = formatted("%.0f reads, energies verified; %.1f %% hold code words only\n", reads,
                               100 * (1 - json.at("invalid_share").number()));
  if (decoding == "weigh")
    text += formatted("all code words weighed by every row's hidden units: worth %.0f independent reads\n",
                      json.at("independent_reads").number());
  else if (decoding == "repair")
    text += formatted("%.0f rows of code words and %.0f repaired ones: repaired rows are no samples of the machine\n",
                      valid, json.at("repaired").number());
  else
    text += formatted("%.0f rows of code words are used: worth %.0f independent reads\n", valid,
                      json.at("independent_reads").number());
  if (!json.at("rows_as_drawn").boolean()) text += "rows are sorted by energy, so errors take reads as independent\n";
  return text;
}

/// One line an outcome: as sampled, and the machine's own probability beside it where it is known.
std::string outcomes_text(const Json& json) {
  std::string text;
  for (const auto& [name, entry] : json.at("outcomes").members()) {
    text += formatted("%-24s %.4f +- %.4f", name.c_str(), entry.at("frequency").number(),
                      entry.at("standard_error").number());
    if (const Json* own = entry.find("machine"))
      text += formatted("   machine's own %.4f, difference %+.1f standard errors", own->number(),
                        entry.at("difference_in_errors").number());
    text += "\n";
  }
  return text;
}

std::string bias_text(const Json& json) {
  const Json& bias = json.at("bias");
  const std::string verdict = bias.at("verdict").string();
  if (verdict == "not checked")
    return "the machine has too many hidden units to sum them: its own probabilities are not known exactly\n";
  if (verdict != "biased") return "no bias found: all outcomes agree with the machine's own probabilities\n";
  const Json& entry = json.at("outcomes").at(bias.at("outcome").string());
  return formatted("BIASED: %s is %.4f, the machine's own %.4f, %.0f standard errors apart; do not use these rows\n",
                   bias.at("outcome").string().c_str(), entry.at("frequency").number(), entry.at("machine").number(),
                   std::abs(bias.at("difference_in_errors").number()));
}

/// Sum over passable outcomes as go and slow_go.
double passable(const Json& answer) {
  double sum = 0;
  for (const auto& [name, probability] : answer.members())
    if (name == "go" || name == "slow_go") sum += probability.number();
  return sum;
}

/// P(go or slow_go) by the machine as exported and by the model, which differ in the inputs that are not clamped.
std::string models_text(const Json& json) {
  std::string text;
  if (const Json* machine = json.find("machine_answer"))
    text += formatted("P(go or slow-go) of the exported machine %.4f", passable(*machine));
  if (const Json* model = json.find("model_answer"))
    text += formatted("%s%.4f by gonogo infer, whose unknown inputs follow the design",
                      text.empty() ? "P(go or slow-go) " : ", ", passable(*model));
  return text.empty() ? "" : text + "\n";
}

std::string import_text(const Json& json) {
  if (!json.find("decoding"))
    return formatted("%.0f reads, energies verified\n", json.at("reads").number()) + chains_text(json);
  std::string text = decoding_text(json) + chains_text(json) + outcomes_text(json);
  for (const auto& [name, entry] : json.at("variables").members())
    text += formatted("%-24s %.4g +- %.2g, standard deviation %.4g %s\n", name.c_str(), entry.at("mean").number(),
                      entry.at("standard_error").number(), entry.at("standard_deviation").number(),
                      entry.at("unit").string().c_str());
  return text + bias_text(json) + models_text(json);
}

}  // namespace

void add_qubo_import(CLI::App& qubo, const SharedQubo& options, const Globals& globals) {
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
  command->add_option("--seed", options->seed, "Seed of weighted_random, and of the rows that are written")
      ->check(kSeed)
      ->capture_default_str();
  command->add_option("--model", options->model, "Also check that the problem was exported from this model")
      ->type_name(kFile);
  command->add_option("--rows", options->rows, "Write the decoded rows as CSV")->type_name(kFile);
  command->add_flag("--inside", options->inside, "Values of the rows uniform inside their bins; otherwise the middles");
  command
      ->add_option(
          "--decode", options->decode,
          "weigh: every row's hidden units weigh all code words; discard: only rows of code words; repair: also "
          "rows that a rule can read")
      ->check(CLI::IsMember({"weigh", "discard", "repair"}))
      ->capture_default_str();
  command->add_option("--min-reads", options->limits.reads, "Refuse answers worth fewer reads")
      ->check(CLI::Range(0.0, 1e12))
      ->capture_default_str();
  command->add_option("--min-share", options->limits.share, "Refuse answers worth a smaller share of their reads")
      ->check(CLI::Range(0.0, 1.0))
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
    request.inside = options->inside;
    request.chains = options->chains;
    request.seed = options->seed;
    request.decoding = options->decode == "weigh"    ? learn::Decoding::weigh
                       : options->decode == "repair" ? learn::Decoding::repair
                                                     : learn::Decoding::discard;
    request.limits = options->limits;
    const Json json = learn::import_answer(request);
    print_result(globals, json, import_text(json));
  });
}

}  // namespace gonogo::app
