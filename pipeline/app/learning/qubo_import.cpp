#include <algorithm>
#include <cmath>
#include <map>

#include "base/format.h"
#include "pipeline/app/learning/qubo_options.h"

namespace gonogo::app {
namespace {

/// How the rows were read, and what that did to the answer.
std::string decoding_text(const outcome::AnswerSummary& summary) {
  std::string text =
      line("%.0f reads, energies verified; %.1f %% %s\n", summary.reads, 100 * (1 - summary.invalid_share),
           summary.free_units ? "give code words by their hidden units" : "hold code words only");
  if (summary.decoding == outcome::Decoding::weigh)
    text += line("all code words weighed by every row's hidden units: worth %.0f independent reads\n",
                 summary.independent_reads);
  else if (summary.decoding == outcome::Decoding::repair)
    text += line("%.0f rows of code words and %.0f repaired ones: repaired rows are no samples of the machine\n",
                 summary.valid, summary.repaired);
  else
    text += line("%.0f rows of code words are used: worth %.0f independent reads\n", summary.valid,
                 summary.independent_reads);
  if (!summary.rows_as_drawn) text += "rows are sorted by energy, so errors take reads as independent\n";
  return text;
}

/// One line an outcome: as sampled, and the machine's own probability beside it where it is known.
std::string outcomes_text(const outcome::AnswerSummary& summary) {
  std::string text;
  for (const outcome::AnswerSummary::Outcome& outcome : summary.outcomes) {
    text += line("%-24s %.4f +- %.4f", outcome.name.c_str(), outcome.frequency.mean, outcome.frequency.standard_error);
    if (!std::isnan(outcome.machine))
      text +=
          line("   machine's own %.4f%s, difference %+.1f standard errors", outcome.machine,
               outcome.machine_error > 0 ? line(" +- %.4f", outcome.machine_error).c_str() : "", outcome.difference);
    text += "\n";
  }
  return text;
}

std::string temperature_text(const outcome::AnswerSummary& summary) {
  if (!summary.temperature) return "";
  const learning::BetaEstimate& beta = summary.temperature->beta;
  const std::string& verdict = summary.temperature->verdict;
  return line("rows follow beta %.3f (95 %%: %.3f to %.3f); the problem means 1%s\n", beta.beta, beta.low, beta.high,
              verdict == "right"       ? ""
              : verdict == "corrected" ? ": corrected by the weights of the rows"
                                       : ": WRONG TEMPERATURE, within --max-beta-error");
}

std::string bias_text(const outcome::AnswerSummary& summary) {
  if (summary.bias.verdict == "not checked")
    return "the machine's own probabilities are not known: units of different variables are coupled\n";
  if (summary.bias.verdict != "biased")
    return "no bias found: all outcomes agree with the machine's own probabilities\n";
  const auto worst = std::find_if(summary.outcomes.begin(), summary.outcomes.end(),
                                  [&](const auto& outcome) { return outcome.name == summary.bias.outcome; });
  return line("BIASED: %s is %.4f, the machine's own %.4f, %.0f standard errors apart; do not use these rows\n",
              worst->name.c_str(), worst->frequency.mean, worst->machine, std::abs(summary.bias.difference));
}

/// Sum over passable outcomes as go and slow_go.
double passable(const std::map<std::string, double>& answer) {
  double sum = 0;
  for (const auto& [name, probability] : answer)
    if (name == "go" || name == "slow_go") sum += probability;
  return sum;
}

/// P(go or slow_go) by the machine as exported and by the model, which differ in the inputs that are not clamped.
std::string models_text(const outcome::ImportedAnswer& answer) {
  std::string text;
  if (!answer.machine_answer.empty())
    text += line("P(go or slow-go) of the exported machine %.4f", passable(answer.machine_answer));
  if (!answer.model_answer.empty())
    text += line("%s%.4f by gonogo infer, whose unknown inputs follow the design",
                 text.empty() ? "P(go or slow-go) " : ", ", passable(answer.model_answer));
  return text.empty() ? "" : text + "\n";
}

std::string import_text(const outcome::ImportedAnswer& answer) {
  const std::string chains =
      answer.chains ? line("%.2f %% of the chains were broken\n", 100 * answer.chains->break_fraction) : "";
  if (!answer.summary) return line("%.0f reads, energies verified\n", answer.reads) + chains;
  const outcome::AnswerSummary& summary = *answer.summary;
  std::string text = decoding_text(summary) + chains + outcomes_text(summary);
  for (const outcome::AnswerSummary::Variable& variable : summary.variables)
    text += line("%-24s %.4g +- %.2g, standard deviation %.4g %s\n", variable.name.c_str(), variable.mean,
                 variable.standard_error, variable.standard_deviation, variable.unit.c_str());
  return text + temperature_text(summary) + bias_text(summary) + models_text(answer);
}

}  // namespace

void add_qubo_import(CLI::App& qubo, const SharedQubo& options, const Globals& globals) {
  CLI::App* command =
      qubo.add_subcommand("import", "Read an answer back: verify it, decode rows to variables and outcomes");
  add_named(*command, "--problem", options->problem, kFile, "Problem that was exported, with its sidecar beside it")
      ->required();
  add_named(*command, "--answer", options->answer, kFile, "Answer file")->required();
  add_named(*command, "--answer-format", options->answer_format, one_of(learning::names_of(learning::answer_formats())),
            "Format of the answer")
      ->capture_default_str();
  add_input_options(command, options);
  add_named(*command, "--chains", options->chains,
            one_of({"weighted_random", "majority_vote", "discard", "minimize_energy"}),
            "How broken chains of an embedded problem are read")
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Seed of weighted_random, and of the rows that are written")
      ->check(kSeed)
      ->capture_default_str();
  add_named(*command, "--model", options->model, kFile, "Also check that the problem was exported from this model");
  add_named(*command, "--rows", options->rows, kFile, "Write the decoded rows as CSV");
  command->add_flag("--inside", options->inside, "Values of the rows uniform inside their bins; otherwise the middles");
  command
      ->add_option(
          "--decode", options->decode,
          "weigh: every row's hidden units weigh all code words; discard: only rows of code words; repair: also "
          "rows that a rule can read")
      ->check(CLI::IsMember({"weigh", "discard", "repair"}))
      ->capture_default_str();
  add_number(*command, "--min-reads", options->limits.reads, {0.0, 1e12}, "Refuse answers worth fewer reads");
  add_number(*command, "--min-share", options->limits.share, {0.0, 1.0},
             "Refuse answers worth a smaller share of their reads");
  add_number(*command, "--max-beta-error", options->limits.temperature, {0.0, INFINITY},
             "Refuse answers whose rows have an inverse temperature farther from 1; inf: take any rows");
  add_examples(*command, {"gonogo qubo import --problem problem.json --answer answer.json --rows rows.csv"});
  command->callback([options, &globals] {
    outcome::ImportRequest request;
    request.problem = options->problem;
    request.answer = options->answer;
    request.problem_file = options->in;
    request.answer_format = options->answer_format;
    request.model = options->model;
    request.rows = options->rows;
    request.inside = options->inside;
    request.chains = options->chains;
    request.seed = options->seed;
    request.decoding = options->decode == "weigh"    ? outcome::Decoding::weigh
                       : options->decode == "repair" ? outcome::Decoding::repair
                                                     : outcome::Decoding::discard;
    request.limits = options->limits;
    const outcome::ImportedAnswer answer = outcome::import_answer(request);
    print_result(globals, outcome::to_json(answer), import_text(answer));
  });
}

}  // namespace gonogo::app
