#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/cli/command.h"
#include "pipeline/learn/named_values.h"
#include "pipeline/learn/predictor.h"
#include "pipeline/study/contract.h"

namespace gonogo::pipeline::cli {
namespace {

Json answer_json(const Predictor& predictor, const std::vector<double>& variables) {
  const learning::PosteriorAnswer answer = predictor.marginal(variables);
  Json json, given = Json::object(), unknown = Json::array(), outcomes = Json::object();
  for (std::size_t v = 0; v < variables.size(); ++v) {
    const std::string& name = contract().variables[v].name;
    if (std::isnan(variables[v]))
      unknown.push_back(name);
    else
      given[name] = variables[v];
  }
  for (std::size_t y = 0; y < answer.probability.size(); ++y) {
    Json entry;
    entry["probability"] = answer.probability[y];
    entry["standard_error"] = answer.standard_error[y];
    outcomes[contract().outcomes[y].name] = std::move(entry);
  }
  json["given"] = std::move(given);
  json["summed_out"] = std::move(unknown);
  json["exact"] = answer.exact;
  json["p_go"] = predictor.p_go(variables);
  json["outcomes"] = std::move(outcomes);
  json["outside_sampled"] = predictor.outside_variable(variables);
  json["novelty"] = predictor.novelty(variables);
  return json;
}

std::string answer_text(const Json& answer) {
  std::string text;
  char line[200];
  for (const auto& [name, entry] : answer.at("outcomes").members()) {
    const double p = entry.at("probability").number(), error = entry.at("standard_error").number();
    std::snprintf(line, sizeof line, error > 0 ? "%-24s %.4f +- %.4f\n" : "%-24s %.4f\n", name.c_str(), p, error);
    text += line;
  }
  std::snprintf(line, sizeof line, "P(go or slow-go)         %.4f\n", answer.at("p_go").number());
  text += line;
  std::string summed;
  for (const Json& name : answer.at("summed_out").items()) summed += " " + name.string();
  if (!summed.empty()) text += "summed out:" + summed + "\n";
  const std::string& outside = answer.at("outside_sampled").string();
  if (!outside.empty())
    text += outside + " lies outside the range in which trials were made: do not trust this answer\n";
  std::snprintf(line, sizeof line, "novelty %.2f (1: as near to a trial as trials are to one another)\n",
                answer.at("novelty").number());
  return text + line;
}

}  // namespace

void add_infer_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("infer", "P(outcome) at one point; variables left out are summed out");
  auto model = std::make_shared<std::string>();
  auto set = std::make_shared<std::vector<std::string>>();
  command->add_option("--model", *model, "Model file")->required();
  command->add_option("--set", *set, "variable=number, in the unit of the contract; may be repeated");
  command->footer("Example:\n  gonogo infer --model out/demo/model.h5 --set slope_along=12 --set friction_angle=32");
  command->callback([model, set, &globals] {
    const std::vector<double> variables = to_variables(parse_named_values(*set));
    const Json answer = answer_json(Predictor::read(*model), variables);
    print_result(globals, answer, answer_text(answer));
  });
}

}  // namespace gonogo::pipeline::cli
