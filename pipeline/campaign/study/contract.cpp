#include "pipeline/campaign/study/contract.h"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "base/error.h"
#include "base/format.h"
#include "base/json/config.h"

namespace gonogo::campaign {

namespace {

constexpr std::array<std::pair<const char*, Verdict>, 4> kVerdicts{
    {{"go", Verdict::go}, {"slow_go", Verdict::slow_go}, {"no_go", Verdict::no_go}, {"unknown", Verdict::unknown}}};

constexpr std::array<std::pair<const char*, Reason>, 17> kReasons{{{"none", Reason::none},
                                                                   {"slope_unstable", Reason::slope_unstable},
                                                                   {"rollover", Reason::rollover},
                                                                   {"slid_back", Reason::slid_back},
                                                                   {"power", Reason::power},
                                                                   {"sinkage", Reason::sinkage},
                                                                   {"traction", Reason::traction},
                                                                   {"obstacle", Reason::obstacle},
                                                                   {"timeout", Reason::timeout},
                                                                   {"simulation_failed", Reason::simulation_failed},
                                                                   {"outside_sampled", Reason::outside_sampled},
                                                                   {"input_missing", Reason::input_missing},
                                                                   {"water", Reason::water},
                                                                   {"vegetation", Reason::vegetation},
                                                                   {"built_up", Reason::built_up},
                                                                   {"land_unknown", Reason::land_unknown},
                                                                   {"soft_soil", Reason::soft_soil}}};

template <class Table>
std::vector<std::string> names_of(const Table& table) {
  std::vector<std::string> names;
  for (const auto& entry : table) names.push_back(entry.name);
  return names;
}

/// Position of the entry called `name`; the InputError names the nearest one.
template <class Table>
std::size_t position(const Table& table, const std::string& name, const std::string& kind) {
  const auto found = std::find_if(table.begin(), table.end(), [&](const auto& entry) { return entry.name == name; });
  if (found != table.end()) return std::size_t(found - table.begin());
  const auto names = names_of(table);
  throw InputError("\"" + name + "\" is no " + kind + "; did you mean \"" + nearest_word(name, names) +
                   "\"? Known: " + join_words(names));
}

EncoderSpec read_encoder(const Config& config) {
  EncoderSpec encoder;
  encoder.code = config.choice("code", {"thermometer", "one_hot", "gray", "binary"});
  encoder.bits = int(config.integer("bits", {.minimum = 1, .maximum = 64}));
  config.finish();
  return encoder;
}

Variable read_variable(const Config& config) {
  Variable v;
  v.name = config.text("name");
  v.label = config.text("label");
  v.unit = config.text("unit");
  const auto range = config.numbers("range");
  if (range.size() != 2 || !(range[0] < range[1])) config.fail("range", "expected [smallest, largest]");
  v.minimum = range[0];
  v.maximum = range[1];
  v.sets = config.text("sets");
  v.source = config.text("source");
  v.prior = config.choice("prior", {"region", "uniform", "fixed", "task", "family"});
  v.encoder = read_encoder(config.object("encoder"));
  config.finish();
  return v;
}

Measure read_measure(const Config& config) {
  Measure measure{config.text("name"), config.text("unit"), config.text("about"), config.text_or("task", "")};
  config.finish();
  return measure;
}

std::string read_colour(const Config& config, const std::string& key) {
  std::string colour = config.text(key);
  const bool hexadecimal = colour.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
  if (colour.size() != 7 || colour[0] != '#' || !hexadecimal) config.fail(key, "expected a colour like \"#1a9641\"");
  return colour;
}

VerdictInfo read_verdict(const Config& config) {
  VerdictInfo info{.name = config.text("name"),
                   .code = int(config.integer("code")),
                   .label = config.text("label"),
                   .colour = read_colour(config, "colour"),
                   .colour_blind_safe = read_colour(config, "colour_blind_safe")};
  config.finish();
  return info;
}

ReasonInfo read_reason(const Config& config, const std::vector<VerdictInfo>& verdicts) {
  ReasonInfo info{.name = config.text("name"),
                  .code = int(config.integer("code")),
                  .verdicts = config.texts("verdicts"),
                  .label = config.text("label"),
                  .colour = read_colour(config, "colour"),
                  .about = config.text("about"),
                  .map_only = config.boolean_or("map_only", false)};
  for (const auto& verdict : info.verdicts) position(verdicts, verdict, "verdict");
  config.finish();
  return info;
}

template <class Table>
void check_unique(const Config& config, const std::string& key, const Table& table) {
  std::set<std::string> seen;
  for (const auto& entry : table)
    if (!seen.insert(entry.name).second) config.fail(key, "\"" + entry.name + "\" appears twice");
}

/// The schema and the enumerators must name the same things by the same codes, in the enumerators' order.
template <class Table, class Enumerators>
void check_codes(const Config& config, const std::string& key, const Table& table, const Enumerators& enumerators) {
  if (table.size() != enumerators.size())
    config.fail(key, "has " + std::to_string(table.size()) + " entries, the program knows " +
                         std::to_string(enumerators.size()));
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table[i].name != enumerators[i].first || table[i].code != int(enumerators[i].second))
      config.fail(key + "[" + std::to_string(i) + "]",
                  "\"" + table[i].name + "\" with code " + std::to_string(table[i].code) + " must be \"" +
                      enumerators[i].first + "\" with code " + std::to_string(int(enumerators[i].second)));
}

/// Every (verdict, reason) pair of a valid trial: verdicts in order, each with the reasons that list it.
std::vector<Outcome> list_outcomes(const Contract& contract) {
  std::vector<Outcome> outcomes;
  for (const auto& [verdict_name, verdict] : kVerdicts) {
    if (verdict == Verdict::unknown) continue;
    for (const auto& [reason_name, reason] : kReasons) {
      const auto& verdicts = contract.info(reason).verdicts;
      if (contract.info(reason).map_only) continue;
      if (std::find(verdicts.begin(), verdicts.end(), verdict_name) == verdicts.end()) continue;
      std::string name = verdict_name;
      if (reason != Reason::none) name += std::string("/") + reason_name;
      outcomes.push_back({verdict, reason, name});
    }
  }
  return outcomes;
}

}  // namespace

Contract parse_contract(std::string_view text, const std::string& name) {
  const Config config = Config::parse(text, name);
  config.choice("schema", {"gonogo/variables/1"});
  config.text("about");
  Contract contract;
  for (const auto& entry : config.objects("variables")) contract.variables.push_back(read_variable(entry));
  for (const auto& entry : config.objects("measures")) contract.measures.push_back(read_measure(entry));
  for (const auto& entry : config.objects("verdicts")) contract.verdicts.push_back(read_verdict(entry));
  for (const auto& entry : config.objects("reasons")) contract.reasons.push_back(read_reason(entry, contract.verdicts));
  config.finish();
  check_unique(config, "variables", contract.variables);
  check_unique(config, "measures", contract.measures);
  check_codes(config, "verdicts", contract.verdicts, kVerdicts);
  check_codes(config, "reasons", contract.reasons, kReasons);
  contract.outcomes = list_outcomes(contract);
  return contract;
}

std::size_t Contract::variable_index(const std::string& name) const { return position(variables, name, "variable"); }

std::size_t Contract::measure_index(const std::string& name) const { return position(measures, name, "measure"); }

std::size_t Contract::outcome_index(Verdict verdict, Reason reason) const {
  for (std::size_t i = 0; i < outcomes.size(); ++i)
    if (outcomes[i].verdict == verdict && outcomes[i].reason == reason) return i;
  throw InputError("verdict \"" + info(verdict).name + "\" with reason \"" + info(reason).name +
                   "\" is not an outcome of a valid trial");
}

// check_codes() makes position and enumerator agree: verdicts count from 1, reasons from 0.
const VerdictInfo& Contract::info(Verdict verdict) const { return verdicts.at(std::size_t(verdict) - 1); }

const ReasonInfo& Contract::info(Reason reason) const { return reasons.at(std::size_t(reason)); }

const Contract& contract() {
  static const Contract compiled_in = parse_contract(contract_text(), "configs/schema/variables.json (compiled in)");
  return compiled_in;
}

double read_value(const Config& config, const std::string& key, const Variable& variable) {
  if (is_task_variable(variable) && config.number(key) == 0) return 0;
  return config.number(key, {variable.minimum, variable.maximum});
}

std::vector<TaskNumber> task_numbers(const std::string& type) {
  std::vector<TaskNumber> numbers;
  const std::string prefix = type + "_";
  for (std::size_t v = 0; v < contract().variables.size(); ++v) {
    const Variable& variable = contract().variables[v];
    if (!is_task_variable(variable) || variable.name.rfind(prefix, 0) != 0) continue;
    const std::string unit = variable.unit == "-" ? "" : "_" + variable.unit;
    numbers.push_back({variable.name.substr(prefix.size()) + unit, v});
  }
  return numbers;
}

bool has_task_values(std::span<const double> variables) {
  for (std::size_t v = 0; v < variables.size(); ++v)
    if (is_task_variable(contract().variables[v]) && variables[v] != 0) return true;
  return false;
}

}  // namespace gonogo::campaign
