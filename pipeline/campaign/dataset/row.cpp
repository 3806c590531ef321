#include "pipeline/campaign/dataset/row.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "base/json/json.h"
#include "pipeline/campaign/study/contract.h"

namespace gonogo::campaign {

namespace {

template <class T>
std::string to_text(T value) {
  if constexpr (std::is_floating_point_v<T>) {
    if (std::isnan(value)) return "nan";
  }
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return std::string(text, end);
}

std::string join(const std::vector<std::string>& cells) {
  std::string row;
  for (const std::string& cell : cells) row += (row.empty() ? "" : ",") + cell;
  return row;
}

/// Takes cells from the front of a row; remembers whether all of them were well-formed.
class Cells {
 public:
  /// `usual`: number of columns without those of some trials alone.
  Cells(std::string_view row, std::size_t usual)
      : rest_(row), with_task_(std::size_t(std::count(row.begin(), row.end(), ',')) + 1 > usual) {}

  std::string_view next() {
    if (ended_) ok_ = false;
    const std::size_t comma = rest_.find(',');
    const std::string_view cell = rest_.substr(0, comma);
    ended_ = comma == std::string_view::npos;
    rest_ = ended_ ? std::string_view() : rest_.substr(comma + 1);
    return cell;
  }

  template <class T>
  void take(T& value) {
    const std::string_view cell = next();
    if constexpr (std::is_floating_point_v<T>) {
      if (cell == "nan") {
        value = std::numeric_limits<T>::quiet_NaN();
        return;
      }
    }
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    ok_ = ok_ && error == std::errc() && end == cell.data() + cell.size();
  }

  template <class Enum, class Info>
  void take_name(Enum& value, const std::vector<Info>& infos) {
    const std::string_view cell = next();
    for (const Info& info : infos) {
      if (info.name != cell) continue;
      value = Enum(info.code);
      return;
    }
    ok_ = false;
  }

  void take_point(DesignPoint& point) {
    take(point.index);
    take(point.seed);
    take(point.replicate_of);
    take(point.proposal_density);
    point.variables.assign(contract().variables.size(), 0);
    for (std::size_t v = 0; v < point.variables.size(); ++v)
      if (has_column(contract().variables[v], with_task_)) take(point.variables[v]);
  }

  /// Names joined by "+", or "none".
  void take_checks(std::uint64_t& bits) {
    std::string_view cell = next();
    bits = 0;
    if (cell == "none") return;
    while (ok_) {
      const std::size_t plus = cell.find('+');
      const std::string_view name = cell.substr(0, plus);
      const auto check = std::find_if(kChecks.begin(), kChecks.end(), [&](const Check& c) { return name == c.name; });
      ok_ = check != kChecks.end();
      if (ok_) bits |= check->bit;
      if (plus == std::string_view::npos) return;
      cell = cell.substr(plus + 1);
    }
  }

  void take_measures(std::vector<double>& measures) {
    measures.assign(contract().measures.size(), kNaN);
    for (std::size_t m = 0; m < measures.size(); ++m)
      if (has_column(contract().measures[m], with_task_)) take(measures[m]);
  }

  /// Whether the row is well-formed, and holds the columns of some trials alone where one is set, and only there.
  bool complete(bool with_task) const { return ok_ && ended_ && with_task_ == with_task; }

 private:
  std::string_view rest_;
  bool with_task_, ok_ = true, ended_ = false;
};

void add_point_cells(const DesignPoint& point, bool with_task, std::vector<std::string>& cells) {
  cells.push_back(to_text(point.index));
  cells.push_back(to_text(point.seed));
  cells.push_back(to_text(point.replicate_of));
  cells.push_back(to_text(point.proposal_density));
  for (std::size_t v = 0; v < point.variables.size(); ++v)
    if (has_column(contract().variables[v], with_task)) cells.push_back(to_text(point.variables[v]));
}

}  // namespace

bool has_task_values(const TrialRecord& record) {
  for (std::size_t m = 0; m < record.measures.size(); ++m)
    if (!contract().measures[m].task.empty() && has_measure(record, m)) return true;
  return has_task_values(record.point.variables);
}

bool has_task_values(const std::vector<TrialRecord>& records) {
  return std::any_of(records.begin(), records.end(), [](const TrialRecord& r) { return has_task_values(r); });
}

std::vector<std::string> point_columns(bool with_task) {
  std::vector<std::string> names{"index", "seed", "replicate_of", "proposal_density"};
  for (const Variable& variable : contract().variables)
    if (has_column(variable, with_task)) names.push_back(variable.name);
  return names;
}

std::vector<std::string> record_columns(bool with_task) {
  std::vector<std::string> names = point_columns(with_task);
  names.insert(names.end(), {"verdict", "reason", "attempts", "failed_checks"});
  for (const Measure& measure : contract().measures)
    if (has_column(measure, with_task)) names.push_back(measure.name);
  return names;
}

std::string point_header_row(bool with_task) { return join(point_columns(with_task)); }

std::string to_row(const DesignPoint& point) {
  std::vector<std::string> cells;
  add_point_cells(point, has_task_values(point.variables), cells);
  return join(cells);
}

namespace {

std::string row_of(const TrialRecord& record, bool with_task) {
  std::vector<std::string> cells;
  add_point_cells(record.point, with_task, cells);
  cells.push_back(contract().info(record.verdict).name);
  cells.push_back(contract().info(record.reason).name);
  cells.push_back(to_text(record.attempts));
  cells.push_back(names_of_checks(record.failed_checks));
  for (std::size_t m = 0; m < record.measures.size(); ++m)
    if (has_column(contract().measures[m], with_task)) cells.push_back(to_text(record.measures[m]));
  return join(cells);
}

}  // namespace

std::string to_row(const TrialRecord& record) { return row_of(record, has_task_values(record)); }

std::optional<DesignPoint> parse_point(std::string_view row) {
  Cells cells(row, point_columns(false).size());
  DesignPoint point;
  cells.take_point(point);
  if (!cells.complete(has_task_values(point.variables))) return std::nullopt;
  return point;
}

std::optional<TrialRecord> parse_record(std::string_view row) {
  Cells cells(row, record_columns(false).size());
  TrialRecord record;
  cells.take_point(record.point);
  cells.take_name(record.verdict, contract().verdicts);
  cells.take_name(record.reason, contract().reasons);
  cells.take(record.attempts);
  cells.take_checks(record.failed_checks);
  cells.take_measures(record.measures);
  if (!cells.complete(has_task_values(record))) return std::nullopt;
  return record;
}

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
    if (has_column(contract().measures[i], with_task))
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
  const bool with_task = has_task_values(dataset.records);
  std::string text = join(record_columns(with_task)) + "\n";
  for (const TrialRecord& record : dataset.records) text += row_of(record, with_task) + "\n";
  return text;
}

std::string to_json_text(const Dataset& dataset) {
  const bool with_task = has_task_values(dataset.records);
  Json units = Json::object();
  for (const Variable& variable : contract().variables)
    if (has_column(variable, with_task)) units[variable.name] = variable.unit;
  for (const Measure& measure : contract().measures)
    if (has_column(measure, with_task)) units[measure.name] = measure.unit;
  Json trials = Json::array();
  for (const TrialRecord& record : dataset.records) trials.push_back(trial_json(record, with_task));
  Json object = Json::object();
  object["provenance"] = provenance_json(dataset.provenance);
  object["units"] = units;
  object["trials"] = trials;
  return object.dump() + "\n";
}

}  // namespace gonogo::campaign
