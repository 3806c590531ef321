#include "pipeline/campaign/dataset/summary.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "base/format.h"
#include "pipeline/campaign/dataset/row.h"
#include "pipeline/campaign/study/contract.h"

namespace gonogo::campaign {
namespace {

constexpr double kSlopeBinWidth = 5;  // [deg]
constexpr int kBarWidth = 40;         // characters of the longest bar

template <class Get>
ValueRange range_of(const std::string& name, const std::string& unit, const std::vector<TrialRecord>& records,
                    Get get) {
  ValueRange range{.name = name, .unit = unit};
  double sum = 0;
  std::size_t count = 0;
  for (const TrialRecord& record : records) {
    const double value = get(record);
    if (std::isnan(value)) continue;
    range.minimum = count == 0 ? value : std::min(range.minimum, value);
    range.maximum = count == 0 ? value : std::max(range.maximum, value);
    sum += value;
    ++count;
  }
  if (count > 0) range.mean = sum / double(count);
  return range;
}

void compare_replicates(const std::vector<TrialRecord>& records, DatasetSummary& summary) {
  std::unordered_map<std::uint64_t, Verdict> verdict_of;
  for (const TrialRecord& record : records) verdict_of[record.point.index] = record.verdict;
  for (const TrialRecord& record : records) {
    if (record.point.replicate_of < 0) continue;
    ++summary.replicates;
    const auto original = verdict_of.find(std::uint64_t(record.point.replicate_of));
    if (original == verdict_of.end() || original->second == Verdict::unknown || record.verdict == Verdict::unknown)
      continue;
    ++summary.replicate_pairs;
    summary.replicate_agree += passes(original->second) == passes(record.verdict);
  }
}

std::vector<SlopeBin> slope_bins(const std::vector<TrialRecord>& records) {
  const std::size_t slope = contract().variable_index("slope_along");
  std::map<long, SlopeBin> bins;
  for (const TrialRecord& record : records) {
    const long number = std::lround(std::floor(record.point.variables[slope] / kSlopeBinWidth));
    SlopeBin& bin = bins[number];
    bin.from = double(number) * kSlopeBinWidth;
    bin.to = bin.from + kSlopeBinWidth;
    switch (record.verdict) {
      case Verdict::go:
        ++bin.go;
        break;
      case Verdict::slow_go:
        ++bin.slow_go;
        break;
      case Verdict::no_go:
        ++bin.no_go;
        break;
      case Verdict::unknown:
        ++bin.unknown;
        break;
    }
  }
  std::vector<SlopeBin> result;
  for (const auto& [number, bin] : bins) result.push_back(bin);
  return result;
}

std::string ranges_text(const std::string& title, const std::vector<ValueRange>& ranges) {
  std::string text = line("%-18s %12s %12s %12s\n", title.c_str(), "minimum", "mean", "maximum");
  for (const ValueRange& range : ranges)
    text += line("%-18s %12.5g %12.5g %12.5g  %s\n", range.name.c_str(), range.minimum, range.mean, range.maximum,
                 range.unit.c_str());
  return text;
}

std::string counts_text(const Counts& counts) {
  std::string text;
  for (const auto& [name, count] : counts) text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + name;
  return text;
}

/// "+" go, "o" slow-go, "x" no-go, "?" unknown; a bar's length is its share of the fullest bin.
std::string histogram_text(const std::vector<SlopeBin>& bins) {
  std::size_t largest = 1;
  for (const SlopeBin& bin : bins) largest = std::max(largest, bin.go + bin.slow_go + bin.no_go + bin.unknown);
  std::string text = "slope along [deg]  (+ go, o slow-go, x no-go, ? unknown)\n";
  for (const SlopeBin& bin : bins) {
    std::string bar;
    std::size_t sum = 0;
    const auto extend = [&](std::size_t count, char mark) {
      sum += count;
      bar.resize(std::size_t(std::lround(double(sum) * kBarWidth / double(std::max<std::size_t>(largest, kBarWidth)))),
                 mark);
    };
    extend(bin.go, '+');
    extend(bin.slow_go, 'o');
    extend(bin.no_go, 'x');
    extend(bin.unknown, '?');
    bar.resize(kBarWidth + 2, ' ');
    const std::size_t valid = bin.go + bin.slow_go + bin.no_go;
    text +=
        line("%5.0f to %3.0f  ", bin.from, bin.to) + bar + line("%zu of %zu passable\n", bin.go + bin.slow_go, valid);
  }
  return text;
}

Json ranges_json(const std::vector<ValueRange>& ranges) {
  const auto number = [](double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); };
  Json object = Json::object();
  for (const ValueRange& range : ranges) {
    Json& entry = object[range.name];
    entry["unit"] = range.unit;
    entry["minimum"] = number(range.minimum);
    entry["mean"] = number(range.mean);
    entry["maximum"] = number(range.maximum);
  }
  return object;
}

}  // namespace

void count_outcome(const TrialRecord& record, Counts& by_verdict, Counts& by_reason) {
  ++by_verdict[contract().info(record.verdict).name];
  ++by_reason[contract().info(record.reason).name];
}

std::string counts_line(const Counts& by_verdict, const Counts& by_reason) {
  std::string text;
  for (const VerdictInfo& verdict : contract().verdicts) {
    const auto found = by_verdict.find(verdict.name);
    if (found == by_verdict.end()) continue;
    text += (text.empty() ? "" : ", ") + std::to_string(found->second) + " " + verdict.name;
    if (verdict.code != int(Verdict::no_go)) continue;
    std::string reasons;
    for (const ReasonInfo& reason : contract().reasons) {
      const auto share = by_reason.find(reason.name);
      const bool of_no_go = reason.verdicts == std::vector<std::string>{verdict.name};
      if (share != by_reason.end() && of_no_go)
        reasons += (reasons.empty() ? "" : ", ") + std::to_string(share->second) + " " + reason.name;
    }
    text += " (" + reasons + ")";
  }
  return text;
}

Json counts_json(const Counts& counts) {
  Json object = Json::object();
  for (const auto& [name, count] : counts) object[name] = std::uint64_t(count);
  return object;
}

DatasetSummary summarise(const std::vector<TrialRecord>& records) {
  DatasetSummary summary;
  summary.trials = records.size();
  for (const TrialRecord& record : records) {
    count_outcome(record, summary.by_verdict, summary.by_reason);
    if (record.verdict == Verdict::unknown)
      summary.failed.emplace_back(record.point.index, names_of_checks(record.failed_checks));
  }
  const bool with_task = has_task_values(records);
  for (std::size_t i = 0; i < contract().variables.size(); ++i) {
    const Variable& variable = contract().variables[i];
    if (!has_column(variable, with_task)) continue;
    summary.variables.push_back(
        range_of(variable.name, variable.unit, records, [i](const auto& r) { return r.point.variables[i]; }));
  }
  for (std::size_t i = 0; i < contract().measures.size(); ++i) {
    const Measure& measure = contract().measures[i];
    if (!has_column(measure, with_task)) continue;
    summary.measures.push_back(
        range_of(measure.name, measure.unit, records, [i](const auto& r) { return r.measures[i]; }));
  }
  compare_replicates(records, summary);
  summary.slope = slope_bins(records);
  return summary;
}

std::string to_text(const DatasetSummary& summary) {
  std::string text = std::to_string(summary.trials) + " trials (" + std::to_string(summary.replicates) +
                     " replicates): " + counts_text(summary.by_verdict) + "\n";
  text += "reasons: " + counts_text(summary.by_reason) + "\n";
  text += "replicates that agree on passable or not: " + std::to_string(summary.replicate_agree) + " of " +
          std::to_string(summary.replicate_pairs) + "\n";
  if (!summary.failed.empty()) {
    text += "failed trials:";
    for (const auto& [index, checks] : summary.failed) text += " " + std::to_string(index) + " (" + checks + ")";
    text += "\n";
  }
  return text + "\n" + ranges_text("variable", summary.variables) + "\n" + ranges_text("measure", summary.measures) +
         "\n" + histogram_text(summary.slope);
}

Json to_json(const DatasetSummary& summary) {
  Json slope = Json::array();
  for (const SlopeBin& bin : summary.slope) {
    Json entry = Json::object();
    entry["from_deg"] = bin.from;
    entry["to_deg"] = bin.to;
    entry["go"] = std::uint64_t(bin.go);
    entry["slow_go"] = std::uint64_t(bin.slow_go);
    entry["no_go"] = std::uint64_t(bin.no_go);
    entry["unknown"] = std::uint64_t(bin.unknown);
    slope.push_back(entry);
  }
  Json object = Json::object();
  object["trials"] = std::uint64_t(summary.trials);
  object["replicates"] = std::uint64_t(summary.replicates);
  object["verdicts"] = counts_json(summary.by_verdict);
  object["reasons"] = counts_json(summary.by_reason);
  object["replicate_pairs"] = std::uint64_t(summary.replicate_pairs);
  object["replicate_agree"] = std::uint64_t(summary.replicate_agree);
  Json failed = Json::object();
  for (const auto& [index, checks] : summary.failed) failed[std::to_string(index)] = checks;
  object["failed"] = failed;
  object["variables"] = ranges_json(summary.variables);
  object["measures"] = ranges_json(summary.measures);
  object["slope_along"] = slope;
  return object;
}

}  // namespace gonogo::campaign
