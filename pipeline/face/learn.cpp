#include <gonogo/learn.h>

#include <cmath>
#include <limits>

#include "base/format.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/face/inside.h"
#include "pipeline/map/trained_model.h"
#include "pipeline/outcome/answer/infer.h"
#include "pipeline/outcome/sampling/rows_file.h"

namespace gonogo::api {

struct Model::Impl {
  std::filesystem::path file;
  outcome::Predictor predictor;
};

namespace {

void check_value(std::size_t variable, double x, const std::string& where) {
  const campaign::Variable& v = campaign::contract().variables[variable];
  if (!campaign::admits(v, x))
    throw gonogo::InputError(where + v.name + ": " + line("%g", x) + " lies outside " +
                             line("%g to %g ", v.minimum, v.maximum) + v.unit);
}

/// [variable]; NaN where nothing is known.
std::vector<double> point_of(const Values& known) {
  std::vector<double> point(campaign::contract().variables.size(), std::numeric_limits<double>::quiet_NaN());
  for (const auto& [name, value] : known) {
    const std::size_t v = campaign::contract().variable_index(name);
    check_value(v, value, "");
    point[v] = value;
  }
  return point;
}

std::optional<std::size_t> outcome_of(const std::string& name) {
  return name.empty() ? std::nullopt : std::optional(outcome::outcome_named(name));
}

}  // namespace

Model Model::read(const std::string& name_or_file) {
  return guarded([&] {
    const auto file = map::find_model(name_or_file);
    return Model(std::make_shared<Impl>(Impl{file, outcome::Predictor::read(file)}));
  });
}

std::filesystem::path Model::file() const { return impl_->file; }
double Model::gravity() const { return outcome::gravity_of(impl_->predictor.model()); }

std::map<std::string, Range> Model::sampled() const {
  const learning::Model& model = impl_->predictor.model();
  std::map<std::string, Range> ranges;
  for (std::size_t v = 0; v < model.sampled_lower.size(); ++v)
    ranges[campaign::contract().variables[v].name] = {model.sampled_lower[v], model.sampled_upper[v]};
  return ranges;
}

double Model::p_go(const Values& known) const {
  return guarded([&] { return impl_->predictor.p_go(point_of(known)); });
}

std::vector<double> Model::p_go(const std::vector<double>& points) const {
  return guarded([&] {
    const std::size_t width = campaign::contract().variables.size();
    if (points.size() % width != 0)
      throw gonogo::InputError("points: " + std::to_string(points.size()) + " numbers; a multiple of " +
                               std::to_string(width) + " is needed, in the order of variables()");
    for (std::size_t k = 0; k < points.size(); ++k)
      check_value(k % width, points[k], "points: row " + std::to_string(k / width) + ": ");
    std::vector<double> result(points.size() / width);
    impl_->predictor.p_go(points, result);
    return result;
  });
}

Answer Model::ask(const Values& known, const std::string& outcome, bool infer) const {
  return guarded([&] {
    const outcome::Answer a = outcome::answer_question(
        impl_->predictor, {.variables = point_of(known), .outcome = outcome_of(outcome), .reconstruct = infer});
    Answer result;
    result.p_go = a.p_go;
    result.outside = a.outside_sampled;
    result.novelty = a.novelty;
    for (const auto& o : a.outcomes) result.outcomes.push_back({o.name, o.probability, o.standard_error});
    if (a.reconstruction)
      for (const auto& u : *a.reconstruction) result.unknown.push_back({u.name, u.mean, u.deviation, {u.low, u.high}});
    return result;
  });
}

SampledRows Model::sample(const RowRequest& request) const {
  return guarded([&] {
    outcome::RowRequest asked;
    asked.rows = request.rows;
    asked.known = point_of(request.known);
    asked.outcome = outcome_of(request.outcome);
    asked.sampler = request.sampler;
    asked.seed = request.seed;
    outcome::SampledRows rows = outcome::sample_rows(impl_->predictor, asked);
    SampledRows result;
    result.effective_rows = outcome::rows_report(impl_->predictor, asked, rows).least_effective_rows;
    result.sampler = rows.sampler;
    for (const campaign::Variable& v : campaign::contract().variables) result.columns.push_back(v.name);
    result.values = std::move(rows.values);
    for (const std::size_t y : rows.outcome) result.outcome.push_back(campaign::contract().outcomes[y].name);
    return result;
  });
}

}  // namespace gonogo::api
