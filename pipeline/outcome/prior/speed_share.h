// The share of the commanded speed to expect of a trial, by a regression on the speeds of other trials. A speed says
// more of a trial than whether it passes.
#pragma once
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/hdf5/hdf5.h"
#include "learning/rbm/regression/gaussian_process.h"
#include "learning/training.h"

namespace gonogo::outcome {

/// What left and right share: the size of the slope across [deg].
double size_across(std::span<const double> variables);

/// Rows with one more input at their end, which `input` takes from the row. points: [row x width]
template <class Input>
std::vector<double> with_input(const std::vector<double>& points, std::size_t width, Input input) {
  std::vector<double> result;
  for (std::size_t first = 0; first < points.size(); first += width) {
    const auto row = std::span(points).subspan(first, width);
    result.insert(result.end(), row.begin(), row.end());
    result.push_back(input(row));
  }
  return result;
}
learning::TrainingTable with_input(learning::TrainingTable table, double (*input)(std::span<const double>));

/// Regression on the margins of a table, which are mean speeds over commanded ones. It takes one more input: what the
/// slope needs of friction beyond what there is.
class SpeedShare {
 public:
  static constexpr std::size_t kFewest = 10;  // trials of known speed that it takes

  /// Whether enough margins of the table are known.
  static bool can_learn(const learning::TrainingTable& table);
  /// table: its first columns are the contract's variables. expected: share that others expect of every row, to which
  /// this adds; empty: none.
  explicit SpeedShare(const learning::TrainingTable& table, const std::vector<double>& expected = {},
                      const learning::GaussianProcessSettings& settings = {});
  /// Share of every row of the table that it was fitted to, as the other rows tell it: a trial's own speed would tell
  /// its outcome.
  std::vector<double> of_rows(const learning::TrainingTable& table, const std::vector<double>& expected = {}) const;
  /// points: [point count x the table's width]; expected: as for the rows.
  std::vector<double> operator()(const std::vector<double>& points, const std::vector<double>& expected = {}) const;

  std::size_t width() const { return width_; }  // of the table

  /// As a group of a file, and from there, without of_rows().
  void write(Hdf5Writer& out, const std::string& group) const;
  static SpeedShare read(const Hdf5Reader& in, const std::string& group);

 private:
  SpeedShare(std::size_t width, learning::GaussianRegression regression)
      : width_(width), regression_(std::move(regression)) {}

  std::size_t width_;
  learning::GaussianRegression regression_;
};

}  // namespace gonogo::outcome
