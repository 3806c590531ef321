#include "pipeline/outcome/sampling/rows_file.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/hdf5/hdf5.h"
#include "pipeline/outcome/training_data.h"

namespace gonogo::outcome {
namespace {

constexpr double kMixed = 1.01;  // largest R-hat of chains that have mixed (Vehtari et al. 2021, section 4.3)

std::string rows_csv(const Predictor& predictor, const SampledRows& rows) {
  const learning::VisibleLayout& layout = predictor.model().layout;
  std::string text;
  for (const learning::Encoder& encoder : layout.encoders()) text += encoder.name() + ",";
  text += "outcome\n";
  for (std::size_t n = 0; n < rows.row_count(); ++n) {
    for (double x : rows.row(n)) text += line("%.17g,", x);
    text += layout.outcomes()[rows.outcome[n]] + "\n";
  }
  return text;
}

void write_hdf5(const std::filesystem::path& path, const Predictor& predictor, const SampledRows& rows,
                const RowsReport& report) {
  const learning::VisibleLayout& layout = predictor.model().layout;
  std::vector<std::string> names, units;
  for (const learning::Encoder& encoder : layout.encoders()) {
    names.push_back(encoder.name());
    units.push_back(encoder.unit());
  }
  std::vector<std::int32_t> outcome(rows.outcome.begin(), rows.outcome.end());
  Hdf5Writer out;
  out.attribute("/", "format", "gonogo/rows/1");
  out.text("report", to_json(report).dump());
  out.array("variables", rows.values, {rows.row_count(), rows.variable_count});
  out.attribute("variables", "names", names);
  out.attribute("variables", "units", units);
  out.array("outcome", outcome);
  out.attribute("outcome", "names", layout.outcomes());
  out.array("chain", rows.chain);
  out.save(path);
}

}  // namespace

RowsReport rows_report(const Predictor& predictor, const RowRequest& request, const SampledRows& rows) {
  const learning::VisibleLayout& layout = predictor.model().layout;
  RowsReport report{.rows = rows.row_count(),
                    .chains = rows.chains,
                    .from = request.source,
                    .sampler = rows.sampler,
                    .independent = rows.independent,
                    .seed = request.seed,
                    .known = {},
                    .known_outcome = request.outcome ? layout.outcomes()[*request.outcome] : std::string(),
                    .outcomes = {},
                    .mixing = {},
                    .largest_r_hat = NAN,
                    .least_effective_rows = NAN,
                    .mixed = {}};
  for (std::size_t v = 0; v < rows.variable_count; ++v)
    if (!std::isnan(request.known[v])) report.known.emplace_back(layout.encoders()[v].name(), request.known[v]);
  const std::vector<int> passable = passable_outcomes();
  for (std::size_t y = 0; y < layout.outcome_count(); ++y) {
    const double count = double(std::count(rows.outcome.begin(), rows.outcome.end(), y));
    report.outcomes.emplace_back(layout.outcomes()[y], count / double(rows.row_count()));
    report.p_go += passable[y] * count / double(rows.row_count());
  }
  const auto add = [&](const std::string& name, const learning::Mixing& mixing) {
    if (std::isnan(mixing.r_hat)) return;
    report.mixing.emplace_back(name, mixing);
    report.largest_r_hat = std::fmax(report.largest_r_hat, mixing.r_hat);
    report.least_effective_rows = std::fmin(report.least_effective_rows, mixing.effective);
  };
  for (std::size_t v = 0; v < rows.variable_count; ++v) add(layout.encoders()[v].name(), rows.of_variable[v]);
  add("outcome", rows.of_outcome);
  if (!std::isnan(report.largest_r_hat)) report.mixed = rows.independent || report.largest_r_hat <= kMixed;
  return report;
}

Json to_json(const RowsReport& report) {
  Json json = Json::Object{{"rows", report.rows},
                           {"from", report.from == RowSource::prior ? "prior" : "machine"},
                           {"sampler", report.sampler},
                           {"chains", report.chains},
                           {"independent", report.independent},
                           {"seed", report.seed}};
  Json known = Json::object(), outcomes = Json::object(), mixing = Json::object();
  for (const auto& [name, value] : report.known) known[name] = value;
  if (!report.known_outcome.empty()) known["outcome"] = report.known_outcome;
  for (const auto& [name, share] : report.outcomes) outcomes[name] = share;
  for (const auto& [name, of] : report.mixing)
    mixing[name] = Json::Object{{"r_hat", of.r_hat}, {"effective_rows", of.effective}};
  json["known"] = std::move(known);
  json["p_go"] = report.p_go;
  json["outcomes"] = std::move(outcomes);
  json["mixing"] = std::move(mixing);
  json["largest_r_hat"] = report.largest_r_hat;
  json["least_effective_rows"] = report.least_effective_rows;
  json["mixed"] = report.mixed ? Json(*report.mixed) : Json();
  return json;
}

std::string rows_text(const RowsReport& report) {
  std::string text = line("%zu rows from the %s by %s, ", report.rows,
                          report.from == RowSource::prior ? "prior" : "machine", report.sampler.c_str());
  text += report.independent ? "each drawn on its own\n" : line("%zu chains\n", report.chains);
  if (!std::isnan(report.largest_r_hat))
    text +=
        line("R-hat at most %.4f, effective rows at least %.0f\n", report.largest_r_hat, report.least_effective_rows);
  if (report.mixed == false)
    text += line(
        "NOT MIXED: R-hat is above %.2f; these rows depend on where the chains started. Raise --burn-in and "
        "--every, or take tempering\n",
        kMixed);
  text += line("P(go or slow-go) %.4f\n", report.p_go);
  for (const auto& [name, share] : report.outcomes)
    if (share > 0) text += line("%-24s %.4f\n", name.c_str(), share);
  return text;
}

void write_rows(const std::filesystem::path& path, const Predictor& predictor, const SampledRows& rows,
                const RowsReport& report) {
  const std::string extension = path.extension().string();
  if (extension == ".csv") return write_file_atomically(path, rows_csv(predictor, rows));
  if (extension == ".h5" || extension == ".hdf5") return write_hdf5(path, predictor, rows, report);
  throw InputError(path.string() + ": rows are written as .csv or .h5; give one of these extensions");
}

}  // namespace gonogo::outcome
