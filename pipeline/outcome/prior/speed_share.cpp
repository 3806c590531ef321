#include "pipeline/outcome/prior/speed_share.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/units.h"
#include "learning/rbm/regression/fit_files.h"
#include "pipeline/campaign/study/contract.h"

namespace gonogo::outcome {
namespace {

/// tan(slope) less the smaller coefficient of friction, between tyre and grains or between grains [-]. NaN where one of
/// them is unknown.
double excess_of_slope(std::span<const double> variables) {
  static const std::size_t slope = campaign::contract().variable_index("slope_along"),
                           soil = campaign::contract().variable_index("friction_angle"),
                           tyre = campaign::contract().variable_index("tyre_friction");
  return std::tan(variables[slope] * kDegree) - std::min(variables[tyre], std::tan(variables[soil] * kDegree));
}

/// Rows whose margin is known.
std::vector<std::size_t> graded_rows(const learning::TrainingTable& table) {
  std::vector<std::size_t> rows;
  for (std::size_t n = 0; n < table.margin.size(); ++n)
    if (!std::isnan(table.margin[n])) rows.push_back(n);
  return rows;
}

/// On the known margins, less what is expected of their rows.
learning::GaussianRegression regression(const learning::TrainingTable& table, const std::vector<double>& expected,
                                        const learning::GaussianProcessSettings& settings) {
  const std::vector<std::size_t> rows = graded_rows(table);
  const learning::TrainingTable inputs = with_input(table.subset(rows), excess_of_slope);
  std::vector<double> target = inputs.margin;
  if (!expected.empty())
    for (std::size_t k = 0; k < rows.size(); ++k) target[k] -= expected[rows[k]];
  return learning::fit_gaussian_regression(inputs, target, settings);
}

}  // namespace

double size_across(std::span<const double> variables) {
  static const std::size_t across = campaign::contract().variable_index("slope_across");
  return std::abs(variables[across]);
}

learning::TrainingTable with_input(learning::TrainingTable table, double (*input)(std::span<const double>)) {
  table.variables = with_input(table.variables, table.variable_count, input);
  ++table.variable_count;
  return table;
}

bool SpeedShare::can_learn(const learning::TrainingTable& table) { return graded_rows(table).size() >= kFewest; }

SpeedShare::SpeedShare(const learning::TrainingTable& table, const std::vector<double>& expected,
                       const learning::GaussianProcessSettings& settings)
    : width_(table.variable_count), regression_(regression(table, expected, settings)) {}

std::vector<double> SpeedShare::of_rows(const learning::TrainingTable& table,
                                        const std::vector<double>& expected) const {
  std::vector<double> shares = (*this)(table.variables, expected);
  const std::vector<std::size_t> known = graded_rows(table);
  for (std::size_t k = 0; k < known.size(); ++k)
    shares[known[k]] = regression_.leave_one_out()[k] + (expected.empty() ? 0 : expected[known[k]]);
  return shares;
}

std::vector<double> SpeedShare::operator()(const std::vector<double>& points,
                                           const std::vector<double>& expected) const {
  std::vector<double> shares = regression_(with_input(points, width_, excess_of_slope));
  for (std::size_t k = 0; k < expected.size(); ++k) shares[k] += expected[k];
  return shares;
}

void SpeedShare::write(Hdf5Writer& out, const std::string& group) const {
  learning::write_fit(out, group, regression_);
}

SpeedShare SpeedShare::read(const Hdf5Reader& in, const std::string& group) {
  learning::GaussianRegression regression = learning::read_regression(in, group);
  const std::size_t inputs = regression.input_count();
  if (inputs < 2) in.fail(group, "has too few inputs; train the model again");
  return {inputs - 1, std::move(regression)};  // the last is what the slope needs
}

}  // namespace gonogo::outcome
