#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/file.h"
#include "base/hdf5/hdf5.h"
#include "base/line.h"
#include "pipeline/learn/sampling/sample_rows.h"
#include "pipeline/learn/training/training_data.h"

namespace gonogo::learn {
namespace {

constexpr double kMixed = 1.01;  // largest R-hat of chains that have mixed (Vehtari et al. 2021, section 4.3)

Json or_null(double x) { return std::isnan(x) ? Json() : Json(x); }

Json mixing_json(const learning::Mixing& mixing) {
  Json json;
  json["r_hat"] = or_null(mixing.r_hat);
  json["effective_rows"] = or_null(mixing.effective);
  return json;
}

void add_mixing(const Predictor& predictor, const SampledRows& rows, Json& json) {
  Json all = Json::object();
  double largest = NAN, least = NAN;
  const auto add = [&](const std::string& name, const learning::Mixing& mixing) {
    if (std::isnan(mixing.r_hat)) return;
    all[name] = mixing_json(mixing);
    largest = std::fmax(largest, mixing.r_hat);
    least = std::fmin(least, mixing.effective);
  };
  for (std::size_t v = 0; v < rows.variable_count; ++v)
    add(predictor.model().layout.encoders()[v].name(), rows.of_variable[v]);
  add("outcome", rows.of_outcome);
  json["mixing"] = std::move(all);
  json["largest_r_hat"] = or_null(largest);
  json["least_effective_rows"] = or_null(least);
  json["mixed"] = std::isnan(largest) ? Json() : Json(rows.independent || largest <= kMixed);
}

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
                const Json& report) {
  const learning::VisibleLayout& layout = predictor.model().layout;
  std::vector<std::string> names, units;
  for (const learning::Encoder& encoder : layout.encoders()) {
    names.push_back(encoder.name());
    units.push_back(encoder.unit());
  }
  std::vector<std::int32_t> outcome(rows.outcome.begin(), rows.outcome.end());
  Hdf5Writer out;
  out.attribute("/", "format", "gonogo/rows/1");
  out.text("report", report.dump());
  out.array("variables", rows.values, {rows.row_count(), rows.variable_count});
  out.attribute("variables", "names", names);
  out.attribute("variables", "units", units);
  out.array("outcome", outcome);
  out.attribute("outcome", "names", layout.outcomes());
  out.array("chain", rows.chain);
  out.save(path);
}

}  // namespace

Json rows_report(const Predictor& predictor, const RowRequest& request, const SampledRows& rows) {
  const learning::VisibleLayout& layout = predictor.model().layout;
  Json json, known = Json::object(), outcomes = Json::object();
  json["rows"] = Json(std::uint64_t(rows.row_count()));
  json["from"] = request.source == RowSource::prior ? "prior" : "machine";
  json["sampler"] = rows.sampler;
  json["chains"] = Json(std::uint64_t(rows.chains));
  json["independent"] = rows.independent;
  json["seed"] = Json(request.seed);
  for (std::size_t v = 0; v < rows.variable_count; ++v)
    if (!std::isnan(request.known[v])) known[layout.encoders()[v].name()] = request.known[v];
  if (request.outcome) known["outcome"] = layout.outcomes()[*request.outcome];
  json["known"] = std::move(known);
  const std::vector<int> passable = passable_outcomes();
  double go = 0;
  for (std::size_t y = 0; y < layout.outcome_count(); ++y) {
    const double count = double(std::count(rows.outcome.begin(), rows.outcome.end(), y));
    outcomes[layout.outcomes()[y]] = count / double(rows.row_count());
    go += passable[y] * count / double(rows.row_count());
  }
  json["p_go"] = go;
  json["outcomes"] = std::move(outcomes);
  add_mixing(predictor, rows, json);
  return json;
}

std::string rows_text(const Json& report) {
  const bool independent = report.at("independent").boolean();
  std::string text = line("%lld rows from the %s by %s, ", static_cast<long long>(report.at("rows").integer()),
                          report.at("from").string().c_str(), report.at("sampler").string().c_str());
  text += independent ? std::string("each drawn on its own\n")
                      : line("%lld chains\n", static_cast<long long>(report.at("chains").integer()));
  if (report.at("largest_r_hat").is_number())
    text += line("R-hat at most %.4f, effective rows at least %.0f\n", report.at("largest_r_hat").number(),
                 report.at("least_effective_rows").number());
  if (report.at("mixed").is_bool() && !report.at("mixed").boolean())
    text += line(
        "NOT MIXED: R-hat is above %.2f; these rows depend on where the chains started. Raise --burn-in and "
        "--every, or take tempering\n",
        kMixed);
  text += line("P(go or slow-go) %.4f\n", report.at("p_go").number());
  for (const auto& [name, share] : report.at("outcomes").members())
    if (share.number() > 0) text += line("%-24s %.4f\n", name.c_str(), share.number());
  return text;
}

void write_rows(const std::filesystem::path& path, const Predictor& predictor, const SampledRows& rows,
                const Json& report) {
  const std::string extension = path.extension().string();
  if (extension == ".csv") return write_file_atomically(path, rows_csv(predictor, rows));
  if (extension == ".h5" || extension == ".hdf5") return write_hdf5(path, predictor, rows, report);
  throw InputError(path.string() + ": rows are written as .csv or .h5; give one of these extensions");
}

}  // namespace gonogo::learn
