#include "pipeline/campaign/dataset/dataset.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/files/file.h"
#include "base/hdf5/hdf5.h"
#include "base/json/config.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/campaign/study/study.h"

namespace gonogo::campaign {

namespace {

constexpr const char* kFormat = "gonogo/dataset/1";

/// All NaNs get the same bits: which sign or payload one has depends on compiler and processor.
double canonical(double x) { return std::isnan(x) ? std::numeric_limits<double>::quiet_NaN() : x; }

void describe(Hdf5Writer& out, const std::string& path, const std::string& unit, const std::string& description) {
  out.attribute(path, "unit", unit);
  out.attribute(path, "description", description);
}

/// Stores a column and lets go of its memory.
template <class T>
void store(Hdf5Writer& out, const std::string& path, std::vector<T>& column, const std::string& unit,
           const std::string& description) {
  out.array(path, column);
  std::vector<T>().swap(column);
  describe(out, path, unit, description);
}

void write_design(Hdf5Writer& out, TrialColumns& columns) {
  store(out, "design/index", columns.index, "-", "position in the design, from 0");
  store(out, "design/seed", columns.seed, "-", "seed of the bed; replicates differ only here");
  store(out, "design/replicate_of", columns.replicate_of, "-",
        "index of the point whose variables this one repeats, or -1");
  store(out, "design/proposal_density", columns.proposal_density, "-",
        "density of the design at this point, relative to uniform over the sampled box");
}

/// Columns that only some trials have stand where a trial sets or measures them.
bool is_stored(const Variable& variable, const std::vector<double>& column) {
  return !is_task_variable(variable) || std::any_of(column.begin(), column.end(), [](double x) { return x != 0; });
}
bool is_stored(const Measure& measure, const std::vector<double>& column) {
  return measure.task.empty() || std::any_of(column.begin(), column.end(), [](double x) { return !std::isnan(x); });
}

void write_values(Hdf5Writer& out, TrialColumns& columns) {
  for (std::size_t i = 0; i < contract().variables.size(); ++i) {
    const Variable& variable = contract().variables[i];
    if (!is_stored(variable, columns.variables[i])) continue;
    const std::string path = "variables/" + variable.name;
    store(out, path, columns.variables[i], variable.unit, variable.label);
    out.attribute(path, "range", std::vector<double>{variable.minimum, variable.maximum});
  }
  for (std::size_t i = 0; i < contract().measures.size(); ++i) {
    const Measure& measure = contract().measures[i];
    if (!is_stored(measure, columns.measures[i])) continue;
    store(out, "measures/" + measure.name, columns.measures[i], measure.unit, measure.about);
  }
}

/// Reasons that a trial can end with: those of maps only stand in no dataset, so that a new one changes no file.
const std::vector<ReasonInfo>& trial_reasons() {
  static const std::vector<ReasonInfo> reasons = [] {
    std::vector<ReasonInfo> list;
    for (const ReasonInfo& reason : contract().reasons)
      if (!reason.map_only) list.push_back(reason);
    return list;
  }();
  return reasons;
}

/// Names and codes of the contract's verdicts or reasons.
template <class Info>
void name_codes(Hdf5Writer& out, const std::string& path, const std::vector<Info>& infos) {
  std::vector<std::string> names;
  std::vector<std::int64_t> codes;
  for (const Info& info : infos) {
    names.push_back(info.name);
    codes.push_back(info.code);
  }
  out.attribute(path, "names", names);
  out.attribute(path, "codes", codes);
}

void write_outcome(Hdf5Writer& out, TrialColumns& columns) {
  store(out, "outcome/verdict", columns.verdict, "-", "how the trial ended");
  name_codes(out, "outcome/verdict", contract().verdicts);
  store(out, "outcome/reason", columns.reason, "-", "why the trial ended so");
  name_codes(out, "outcome/reason", trial_reasons());
  store(out, "outcome/attempts", columns.attempts, "-",
        "2 when the first attempt failed a check and a smaller step was used");
  store(out, "outcome/failed_checks", columns.failed_checks, "-", "bits of the checks that an unknown trial failed");
  std::vector<std::string> names;
  std::vector<std::int64_t> bits;
  for (const Check& check : kChecks) {
    names.push_back(check.name);
    bits.push_back(std::int64_t(check.bit));
  }
  out.attribute("outcome/failed_checks", "names", names);
  out.attribute("outcome/failed_checks", "bits", bits);
}

void write_pairs(Hdf5Writer& out, const std::string& path, const Provenance::Pairs& pairs) {
  std::vector<std::string> names, values;
  for (const auto& [name, value] : pairs) {
    names.push_back(name);
    values.push_back(value);
  }
  out.texts(path + "/names", names);
  out.texts(path + "/values", values);
}

Provenance::Pairs read_pairs(const Hdf5Reader& in, const std::string& path) {
  const std::vector<std::string> names = in.texts(path + "/names"), values = in.texts(path + "/values");
  if (names.size() != values.size()) in.fail(path, "names and values differ in number; the file is damaged");
  Provenance::Pairs pairs;
  for (std::size_t i = 0; i < names.size(); ++i) pairs.emplace_back(names[i], values[i]);
  return pairs;
}

void write_provenance(Hdf5Writer& out, const Provenance& provenance) {
  out.text("provenance/study", provenance.study);
  out.attribute("provenance", "contract_hash", provenance.contract_hash);
  out.attribute("provenance", "program_version", provenance.program_version);
  out.attribute("provenance", "backend", provenance.backend);
  write_pairs(out, "provenance/inputs", provenance.inputs);
  write_pairs(out, "provenance/libraries", provenance.libraries);
  write_pairs(out, "provenance/files", provenance.files);
}

Provenance read_provenance(const Hdf5Reader& in) {
  return {.study = in.text("provenance/study"),
          .contract_hash = in.text_attribute("provenance", "contract_hash"),
          .program_version = in.text_attribute("provenance", "program_version"),
          .backend = in.text_attribute("provenance", "backend"),
          .inputs = read_pairs(in, "provenance/inputs"),
          .libraries = read_pairs(in, "provenance/libraries"),
          .files = in.has("provenance/files") ? read_pairs(in, "provenance/files") : Provenance::Pairs{}};
}

/// The names below `group` must be those of the contract, in any order.
template <class Entry>
void require_names(const Hdf5Reader& in, const std::string& group, const std::vector<Entry>& entries) {
  std::vector<std::string> expected;
  for (const Entry& entry : entries) expected.push_back(entry.name);
  std::sort(expected.begin(), expected.end());
  const std::vector<std::string> found = in.members(group);
  std::vector<std::string> differing;
  std::set_symmetric_difference(expected.begin(), expected.end(), found.begin(), found.end(),
                                std::back_inserter(differing));
  if (!differing.empty())
    in.fail(group + "/" + differing.front(),
            "in only one of file and program: the dataset was made for another contract; run its campaign again");
  for (const Entry& entry : entries)
    if (in.text_attribute(group + "/" + entry.name, "unit") != entry.unit)
      in.fail(group + "/" + entry.name, "is in another unit than " + entry.unit + "; run its campaign again");
}

template <class Info>
void require_codes(const Hdf5Reader& in, const std::string& path, const std::vector<Info>& infos) {
  const std::vector<std::string> names = in.texts_attribute(path, "names");
  const std::vector<std::int64_t> codes = in.integers_attribute(path, "codes");
  bool same = names.size() == infos.size() && codes.size() == infos.size();
  for (std::size_t i = 0; same && i < infos.size(); ++i) same = names[i] == infos[i].name && codes[i] == infos[i].code;
  if (!same) in.fail(path, "uses other names or codes than this program; run its campaign again");
}

template <class Info>
void require_code(const Hdf5Reader& in, const std::string& path, const std::vector<Info>& infos, int code) {
  if (std::none_of(infos.begin(), infos.end(), [code](const Info& info) { return info.code == code; }))
    in.fail(path, "code " + std::to_string(code) + " has no name; the file is damaged");
}

void read_design(const Hdf5Reader& in, std::vector<TrialRecord>& records) {
  const Shape rows{records.size()};
  const auto index = in.array<std::uint64_t>("design/index", rows), seed = in.array<std::uint64_t>("design/seed", rows);
  const auto replicate_of = in.array<std::int64_t>("design/replicate_of", rows);
  const auto density = in.array<double>("design/proposal_density", rows);
  for (std::size_t row = 0; row < records.size(); ++row)
    records[row].point = {.index = index[row],
                          .seed = seed[row],
                          .replicate_of = replicate_of[row],
                          .proposal_density = density[row],
                          .variables = {}};
}

/// Those of the contract, without those of some trials alone that the file lacks.
template <class Entry>
std::vector<Entry> stored_entries(const Hdf5Reader& in, const std::string& group, std::vector<Entry> entries) {
  std::erase_if(entries, [&](const Entry& e) { return !has_column(e, false) && !in.has(group + "/" + e.name); });
  return entries;
}

/// A column of numbers; where the file lacks it, `missing` in every row.
std::vector<double> column_or(const Hdf5Reader& in, const std::string& path, std::size_t rows, double missing) {
  return in.has(path) ? in.array<double>(path, Shape{rows}) : std::vector<double>(rows, missing);
}

void read_values(const Hdf5Reader& in, std::vector<TrialRecord>& records) {
  require_names(in, "variables", stored_entries(in, "variables", contract().variables));
  require_names(in, "measures", stored_entries(in, "measures", contract().measures));
  for (TrialRecord& record : records) {
    record.point.variables.reserve(contract().variables.size());
    record.measures.reserve(contract().measures.size());
  }
  for (const Variable& variable : contract().variables) {
    const auto values = column_or(in, "variables/" + variable.name, records.size(), 0);
    for (std::size_t row = 0; row < records.size(); ++row) records[row].point.variables.push_back(values[row]);
  }
  for (const Measure& measure : contract().measures) {
    const auto values = column_or(in, "measures/" + measure.name, records.size(), kNaN);
    for (std::size_t row = 0; row < records.size(); ++row) records[row].measures.push_back(values[row]);
  }
}

void read_outcome(const Hdf5Reader& in, std::vector<TrialRecord>& records) {
  const Shape rows{records.size()};
  require_codes(in, "outcome/verdict", contract().verdicts);
  require_codes(in, "outcome/reason", trial_reasons());
  const auto verdict = in.array<std::int32_t>("outcome/verdict", rows);
  const auto reason = in.array<std::int32_t>("outcome/reason", rows);
  const auto attempts = in.array<std::uint64_t>("outcome/attempts", rows);
  const auto failed_checks = in.array<std::uint64_t>("outcome/failed_checks", rows);
  for (std::size_t row = 0; row < records.size(); ++row) {
    require_code(in, "outcome/verdict", contract().verdicts, verdict[row]);
    require_code(in, "outcome/reason", trial_reasons(), reason[row]);
    records[row].verdict = Verdict(verdict[row]);
    records[row].reason = Reason(reason[row]);
    records[row].attempts = attempts[row];
    records[row].failed_checks = failed_checks[row];
  }
}

}  // namespace

TrialColumns::TrialColumns(std::size_t expected_rows)
    : variables(contract().variables.size()), measures(contract().measures.size()) {
  const auto reserve = [expected_rows](auto&... columns) { (columns.reserve(expected_rows), ...); };
  reserve(index, seed, replicate_of, proposal_density, verdict, reason, attempts, failed_checks);
  for (auto& column : variables) column.reserve(expected_rows);
  for (auto& column : measures) column.reserve(expected_rows);
}

void TrialColumns::append(const TrialRecord& record) {
  const DesignPoint& point = record.point;
  if (point.variables.size() != variables.size() || record.measures.size() != measures.size())
    throw InputError("dataset: trial " + std::to_string(point.index) +
                     " has another number of variables or measures than the contract");
  index.push_back(point.index);
  seed.push_back(point.seed);
  replicate_of.push_back(point.replicate_of);
  proposal_density.push_back(point.proposal_density);
  for (std::size_t i = 0; i < variables.size(); ++i) variables[i].push_back(canonical(point.variables[i]));
  verdict.push_back(int(record.verdict));
  reason.push_back(int(record.reason));
  attempts.push_back(record.attempts);
  failed_checks.push_back(record.failed_checks);
  for (std::size_t i = 0; i < measures.size(); ++i) measures[i].push_back(canonical(record.measures[i]));
}

std::string dataset_image(TrialColumns columns, const Provenance& provenance) {
  Hdf5Writer out;
  out.attribute("", "format", kFormat);
  out.attribute("", "about",
                "gonogo dataset: one row per simulated trial; see /provenance for what the rows depend on");
  write_design(out, columns);
  write_values(out, columns);
  write_outcome(out, columns);
  write_provenance(out, provenance);
  return out.image();
}

std::string dataset_image(const Dataset& dataset) {
  TrialColumns columns(dataset.records.size());
  for (const TrialRecord& record : dataset.records) columns.append(record);
  return dataset_image(std::move(columns), dataset.provenance);
}

void write_dataset(const std::filesystem::path& path, const Dataset& dataset) {
  write_file_atomically(path, dataset_image(dataset));
}

Dataset read_dataset(const std::filesystem::path& path) {
  const Hdf5Reader in(path);
  if (!in.has_attribute("", "format") || in.text_attribute("", "format") != kFormat)
    in.fail("", std::string("is no dataset of the format ") + kFormat + "; give the dataset.h5 of a campaign");
  Dataset dataset;
  const Shape shape = in.shape("design/index");
  if (shape.size() != 1) in.fail("design/index", "is no list; the file is damaged");
  dataset.records.resize(shape[0]);
  read_design(in, dataset.records);
  read_values(in, dataset.records);
  read_outcome(in, dataset.records);
  dataset.provenance = read_provenance(in);
  return dataset;
}

const std::string* input_text(const Provenance& provenance, const char* name) {
  for (const auto& [key, text] : provenance.files)
    if (key == name) return &text;
  return nullptr;
}

TrialSettings settings_of(const Provenance& provenance, const std::string& where) {
  TrialSettings s;
  if (provenance.study.empty()) return s;
  const Config study = Config::parse(provenance.study, where + ": study");
  s.gravity = study.number_or("gravity", s.gravity, kGravityRange);
  if (const auto trial = study.object_if("trial")) {
    s.compliant_tyres = trial->boolean_or("compliant_tyres", s.compliant_tyres);
    s.wheel_rolling = trial->number_or("wheel_rolling", s.wheel_rolling, kWheelRollingRange);
  }
  return s;
}

}  // namespace gonogo::campaign
