#include "pipeline/campaign/dataset/check.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "base/error.h"
#include "base/format.h"
#include "base/math/statistics.h"
#include "pipeline/campaign/dataset/row.h"
#include "pipeline/campaign/study/contract.h"

namespace gonogo::campaign {

namespace {

constexpr std::size_t kMaxShown = 20;

std::string trial_name(const TrialRecord& record) { return "trial " + std::to_string(record.point.index) + ": "; }

void check_variables(const TrialRecord& record, std::vector<std::string>& faults) {
  for (std::size_t i = 0; i < contract().variables.size(); ++i) {
    const Variable& variable = contract().variables[i];
    const double value = record.point.variables[i];
    if (!std::isfinite(value) || !admits(variable, value))
      faults.push_back(trial_name(record) + line("%s is %g %s, allowed is [%g, %g]", variable.name.c_str(), value,
                                                 variable.unit.c_str(), variable.minimum, variable.maximum));
  }
  if (!(record.point.proposal_density > 0 && std::isfinite(record.point.proposal_density)))
    faults.push_back(trial_name(record) + line("its proposal density is %g", record.point.proposal_density));
}

void check_outcome(const TrialRecord& record, std::vector<std::string>& faults) {
  const std::string& verdict = contract().info(record.verdict).name;
  const auto& verdicts = contract().info(record.reason).verdicts;
  if (std::find(verdicts.begin(), verdicts.end(), verdict) == verdicts.end())
    faults.push_back(trial_name(record) + "verdict " + verdict + " with reason " + contract().info(record.reason).name);
  const bool measured =
      std::any_of(record.measures.begin(), record.measures.end(), [](double x) { return !std::isnan(x); });
  if (record.verdict != Verdict::unknown && !measured) faults.push_back(trial_name(record) + "has no measures");
  if (record.attempts != 1 && record.attempts != 2)
    faults.push_back(trial_name(record) + "took " + std::to_string(record.attempts) + " attempts");
  const bool failed = record.failed_checks != 0;
  if (failed != (record.verdict == Verdict::unknown) || record.failed_checks >= 2 * kChecks.back().bit)
    faults.push_back(trial_name(record) + "verdict " + verdict + " with failed checks " +
                     names_of_checks(record.failed_checks));
}

void check_replicate(const TrialRecord& record, const std::map<std::uint64_t, const TrialRecord*>& earlier,
                     std::vector<std::string>& faults) {
  if (record.point.replicate_of < 0) return;
  const auto found = earlier.find(std::uint64_t(record.point.replicate_of));
  if (found == earlier.end())
    faults.push_back(trial_name(record) + "repeats trial " + std::to_string(record.point.replicate_of) +
                     ", which does not come before it");
  else if (found->second->point.variables != record.point.variables)
    faults.push_back(trial_name(record) + "has other variables than the trial that it repeats");
  else if (found->second->point.seed == record.point.seed)
    faults.push_back(trial_name(record) + "has the bed of the trial that it repeats");
}

/// By column.
std::map<std::string, std::string> cells_of(const TrialRecord& record) {
  std::map<std::string, std::string> cells;
  std::istringstream in(to_row(record));
  for (const std::string& column : record_columns(has_task_values(record))) std::getline(in, cells[column], ',');
  return cells;
}

std::map<std::string, std::string> provenance_entries(const Provenance& p) {
  std::map<std::string, std::string> entries{
      {"study", p.study}, {"contract", p.contract_hash}, {"program", p.program_version}, {"backend", p.backend}};
  for (const auto& [name, hash] : p.inputs) entries["content of " + name] = hash;
  for (const auto& [name, version] : p.libraries) entries[name] = version;
  return entries;
}

std::vector<std::string> provenance_differences(const Provenance& first, const Provenance& second) {
  std::vector<std::string> differences;
  auto a = provenance_entries(first), b = provenance_entries(second);
  for (const auto& [name, value] : b) a.try_emplace(name, "nothing");
  for (const auto& [name, value] : a) {
    const auto other = b.find(name);
    const std::string theirs = other == b.end() ? "nothing" : other->second;
    if (theirs == value) continue;
    differences.push_back(name == "study" ? "the study"
                                          : line("%s: %s against %s", name.c_str(), value.c_str(), theirs.c_str()));
  }
  return differences;
}

/// The study without its number of points, which may grow.
Json comparable_study(const Dataset& dataset, const std::string& name) {
  const Json study = Json::parse(dataset.provenance.study, name + ": study");
  Json result = Json::object();
  for (const auto& [key, value] : study.members()) {
    if (key != "design" || !value.is_object()) {
      result[key] = value;
      continue;
    }
    result[key] = Json::object();
    for (const auto& [member, content] : value.members())
      if (member != "points") result[key][member] = content;
  }
  return result;
}

void require_one_campaign(const Dataset& first, const Dataset& next, const std::string& a, const std::string& b) {
  std::vector<std::string> differing = provenance_differences(first.provenance, next.provenance);
  if (comparable_study(first, a).dump() == comparable_study(next, b).dump()) std::erase(differing, "the study");
  if (!differing.empty())
    throw InputError(a + " and " + b + ": their trials depend on different inputs (" + differing.front() +
                     "), so they cannot be one dataset; train on each alone");
}

template <class Range, class Show>
std::string list_text(const Range& range, Show show) {
  std::string text;
  std::size_t shown = 0;
  for (const auto& entry : range) {
    if (shown++ == kMaxShown) return text + "  and " + std::to_string(range.size() - kMaxShown) + " more\n";
    text += "  " + show(entry) + "\n";
  }
  return text;
}

}  // namespace

std::vector<std::string> faults_of(const Dataset& dataset) {
  std::vector<std::string> faults;
  std::map<std::uint64_t, const TrialRecord*> earlier;
  for (const TrialRecord& record : dataset.records) {
    if (!earlier.empty() && record.point.index <= earlier.rbegin()->first)
      faults.push_back(trial_name(record) + "comes after trial " + std::to_string(earlier.rbegin()->first));
    check_variables(record, faults);
    check_outcome(record, faults);
    check_replicate(record, earlier, faults);
    earlier.emplace(record.point.index, &record);
  }
  return faults;
}

DatasetDifference difference(const Dataset& first, const Dataset& second) {
  DatasetDifference result;
  result.provenance = provenance_differences(first.provenance, second.provenance);
  std::map<std::uint64_t, const TrialRecord*> theirs;
  for (const TrialRecord& record : second.records) theirs.emplace(record.point.index, &record);
  const std::vector<std::string> columns =
      record_columns(has_task_values(first.records) || has_task_values(second.records));
  for (const TrialRecord& record : first.records) {
    const auto found = theirs.find(record.point.index);
    if (found == theirs.end()) {
      result.only_first.push_back(record.point.index);
      continue;
    }
    ++result.common;
    std::map<std::string, std::string> a = cells_of(record), b = cells_of(*found->second);
    for (const std::string& column : columns)
      if (a[column] != b[column]) result.rows.push_back({record.point.index, column, a[column], b[column]});
    theirs.erase(found);
  }
  for (const auto& [index, record] : theirs) result.only_second.push_back(index);
  return result;
}

std::string to_text(const DatasetDifference& d) {
  if (d.none()) return std::to_string(d.common) + " trials, the same bits\n";
  std::string text = std::to_string(d.common) + " trials in both\n";
  if (!d.provenance.empty())
    text += "they depend on different inputs:\n" + list_text(d.provenance, [](const std::string& s) { return s; });
  const auto number = [](std::uint64_t index) { return "trial " + std::to_string(index); };
  if (!d.only_first.empty()) text += "only in the first:\n" + list_text(d.only_first, number);
  if (!d.only_second.empty()) text += "only in the second:\n" + list_text(d.only_second, number);
  if (!d.rows.empty())
    text +=
        "different values:\n" + list_text(d.rows, [](const RowDifference& row) {
          return "trial " + std::to_string(row.index) + " " + row.column + ": " + row.first + " against " + row.second;
        });
  return text;
}

Dataset merge_datasets(const std::vector<Dataset>& parts, const std::vector<std::string>& names) {
  std::map<std::uint64_t, TrialRecord> records;
  std::size_t longest = 0;
  for (std::size_t part = 0; part < parts.size(); ++part) {
    if (part > 0) require_one_campaign(parts[0], parts[part], names[0], names[part]);
    if (parts[part].records.size() > parts[longest].records.size()) longest = part;
    for (const TrialRecord& record : parts[part].records) {
      const auto [place, is_new] = records.emplace(record.point.index, record);
      if (!is_new && to_row(place->second) != to_row(record))
        throw InputError(names[part] + ": trial " + std::to_string(record.point.index) +
                         " has another result in an earlier file; gonogo dataset diff shows the difference");
    }
  }
  Dataset merged{.records = {}, .provenance = parts.at(longest).provenance};
  for (auto& [index, record] : records) merged.records.push_back(std::move(record));
  return merged;
}

namespace {

using Pair = std::pair<const TrialRecord*, const TrialRecord*>;

std::vector<Pair> valid_pairs(const Dataset& first, const Dataset& second) {
  std::map<std::uint64_t, const TrialRecord*> theirs;
  for (const TrialRecord& record : second.records) theirs.emplace(record.point.index, &record);
  std::vector<Pair> pairs;
  for (const TrialRecord& record : first.records) {
    const auto found = theirs.find(record.point.index);
    if (found == theirs.end() || found->second->point.variables != record.point.variables) continue;
    if (record.verdict != Verdict::unknown && found->second->verdict != Verdict::unknown)
      pairs.emplace_back(&record, found->second);
  }
  return pairs;
}

MeasureChange change_of(const std::vector<Pair>& pairs, std::size_t measure) {
  MeasureChange change{.name = contract().measures[measure].name, .unit = contract().measures[measure].unit};
  std::vector<double> differences;
  for (const auto& [a, b] : pairs) {
    const double difference = b->measures[measure] - a->measures[measure];
    if (!passes(a->verdict) || !passes(b->verdict) || std::isnan(difference)) continue;
    differences.push_back(difference);
  }
  change.pairs = differences.size();
  const MeanError of = mean_error(differences);
  if (change.pairs > 0) change.mean = of.mean;
  if (change.pairs > 1) change.error = of.error;
  return change;
}

}  // namespace

PairedTrials paired(const Dataset& first, const Dataset& second) {
  PairedTrials result;
  const std::vector<Pair> pairs = valid_pairs(first, second);
  result.pairs = pairs.size();
  for (const auto& [a, b] : pairs) {
    ++result.verdicts[{contract().info(a->verdict).name, contract().info(b->verdict).name}];
    result.now_pass += !passes(a->verdict) && passes(b->verdict);
    result.now_fail += passes(a->verdict) && !passes(b->verdict);
  }
  const bool with_task = has_task_values(first.records) && has_task_values(second.records);
  for (std::size_t m = 0; m < contract().measures.size(); ++m)
    if (has_column(contract().measures[m], with_task)) result.measures.push_back(change_of(pairs, m));
  return result;
}

std::string to_text(const PairedTrials& p) {
  if (p.pairs == 0) return "";
  std::size_t same = 0;
  std::string changed;
  for (const auto& [names, count] : p.verdicts)
    if (names.first == names.second)
      same += count;
    else
      changed += (changed.empty() ? "" : ", ") + std::to_string(count) + " from " + names.first + " to " + names.second;
  std::string text = line("verdicts of %zu valid trials at the same points: %zu equal", p.pairs, same) +
                     (changed.empty() ? "" : ", " + changed) +
                     line("; %zu pass now, %zu fail now\n", p.now_pass, p.now_fail);
  text += "where both pass, the second less the first, mean and standard error:\n";
  for (const MeasureChange& m : p.measures)
    if (m.pairs > 1) text += line("  %-18s %+11.4g +- %-10.2g %s\n", m.name.c_str(), m.mean, m.error, m.unit.c_str());
  return text;
}

Json to_json(const PairedTrials& p) {
  const auto number = [](double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); };
  Json result = Json::object();
  result["pairs"] = std::uint64_t(p.pairs);
  result["now_pass"] = std::uint64_t(p.now_pass);
  result["now_fail"] = std::uint64_t(p.now_fail);
  Json& verdicts = result["verdicts"] = Json::array();
  for (const auto& [names, count] : p.verdicts) {
    Json entry = Json::object();
    entry["first"] = names.first;
    entry["second"] = names.second;
    entry["trials"] = std::uint64_t(count);
    verdicts.push_back(std::move(entry));
  }
  Json& measures = result["measures"] = Json::object();
  for (const MeasureChange& m : p.measures) {
    Json entry = Json::object();
    entry["unit"] = m.unit;
    entry["pairs"] = std::uint64_t(m.pairs);
    entry["mean"] = number(m.mean);
    entry["standard_error"] = number(m.error);
    measures[m.name] = std::move(entry);
  }
  return result;
}

}  // namespace gonogo::campaign
