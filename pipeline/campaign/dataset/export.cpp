#include "pipeline/campaign/dataset/export.h"

#include <cmath>

#include "base/error.h"
#include "base/json/json.h"
#include "pipeline/campaign/dataset/row.h"
#include "pipeline/campaign/study/task_variables.h"

namespace gonogo::campaign {
namespace {

Json number_or_null(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

Json trial_json(const TrialRecord& record, bool with_task) {
  Json trial = Json::object();
  trial["index"] = record.point.index;
  trial["seed"] = record.point.seed;
  trial["replicate_of"] = record.point.replicate_of;
  trial["proposal_density"] = record.point.proposal_density;
  for (std::size_t i = 0; i < record.point.variables.size(); ++i)
    if (has_column(contract().variables[i], with_task))
      trial[contract().variables[i].name] = number_or_null(record.point.variables[i]);
  trial["verdict"] = contract().info(record.verdict).name;
  trial["reason"] = contract().info(record.reason).name;
  trial["attempts"] = record.attempts;
  trial["failed_checks"] = names_of_checks(record.failed_checks);
  for (std::size_t i = 0; i < record.measures.size(); ++i)
    trial[contract().measures[i].name] = number_or_null(record.measures[i]);
  return trial;
}

Json pairs_json(const Provenance::Pairs& pairs) {
  Json object = Json::object();
  for (const auto& [name, value] : pairs) object[name] = value;
  return object;
}

Json provenance_json(const Provenance& provenance) {
  Json object = Json::object();
  object["study"] = Json::parse(provenance.study, "study stored in the dataset");
  object["contract_hash"] = provenance.contract_hash;
  object["program_version"] = provenance.program_version;
  object["backend"] = provenance.backend;
  object["inputs"] = pairs_json(provenance.inputs);
  object["libraries"] = pairs_json(provenance.libraries);
  return object;
}

}  // namespace

std::string to_csv(const Dataset& dataset) {
  std::string text = header_row(has_task_values(dataset.records)) + "\n";
  for (const TrialRecord& record : dataset.records) text += to_row(record) + "\n";
  return text;
}

Dataset parse_csv(const std::string& text, const std::string& name) {
  Dataset dataset;
  std::size_t begin = 0;
  for (std::size_t line = 1; begin < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string_view row = std::string_view(text).substr(begin, end - begin);
    begin = end + 1;
    if (line == 1) {
      if (row != header_row(false) && row != header_row(true))
        throw InputError(name + ": line 1: the columns must be " + header_row(false));
      continue;
    }
    const std::optional<TrialRecord> record = parse_record(row);
    if (!record) throw InputError(name + ": line " + std::to_string(line) + ": is not a trial of this table's columns");
    dataset.records.push_back(*record);
  }
  if (text.empty()) throw InputError(name + ": is empty, a table with a header line is needed");
  return dataset;
}

std::string to_json_text(const Dataset& dataset) {
  const bool with_task = has_task_values(dataset.records);
  Json units = Json::object();
  for (const Variable& variable : contract().variables)
    if (has_column(variable, with_task)) units[variable.name] = variable.unit;
  for (const Measure& measure : contract().measures) units[measure.name] = measure.unit;
  Json trials = Json::array();
  for (const TrialRecord& record : dataset.records) trials.push_back(trial_json(record, with_task));
  Json object = Json::object();
  object["provenance"] = provenance_json(dataset.provenance);
  object["units"] = units;
  object["trials"] = trials;
  return object.dump() + "\n";
}

}  // namespace gonogo::campaign
