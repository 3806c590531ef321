#include "pipeline/campaign/dataset/paired.h"

#include <cmath>

#include "base/line.h"
#include "base/mean_error.h"

namespace gonogo::campaign {
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
  for (std::size_t m = 0; m < contract().measures.size(); ++m) result.measures.push_back(change_of(pairs, m));
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
