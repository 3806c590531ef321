#include "pipeline/outcome/importance/importance.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "base/math/random.h"
#include "pipeline/campaign/dataset/summary.h"
#include "pipeline/campaign/design/sobol.h"

namespace gonogo::outcome {
namespace {

constexpr std::uint64_t kShuffleStream = 0x7065726d00000000;

/// Fisher and Yates' shuffle of one column of `points`.
void shuffle_column(std::vector<double>& points, std::size_t dimensions, std::size_t column, std::uint64_t seed,
                    std::uint64_t stream) {
  for (std::size_t i = points.size() / dimensions; i > 1; --i) {
    const std::size_t j = std::size_t(random_bits(seed, stream, i) % i);
    std::swap(points[(i - 1) * dimensions + column], points[j * dimensions + column]);
  }
}

double mean_squared_error(const ManyValues& function, std::span<const double> points, std::span<const double> truth) {
  std::vector<double> values(truth.size());
  function(points, values);
  double sum = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) sum += (values[i] - truth[i]) * (values[i] - truth[i]);
  return sum / double(truth.size());
}

}  // namespace

TotalIndices sobol_total_indices(const ManyValues& function, const InputBox& box, std::uint32_t samples,
                                 std::uint64_t seed) {
  const std::size_t d = box.minimum.size();
  if (2 * d > std::size_t(campaign::kSobolDimensions))
    throw InputError("total indices of " + std::to_string(d) + " inputs: at most " +
                     std::to_string(campaign::kSobolDimensions / 2) + " are possible");
  std::vector<double> a(samples * d), b(samples * d), values(samples), changed(samples);
  for (std::uint32_t i = 0; i < samples; ++i)
    for (std::size_t j = 0; j < d; ++j) {
      const double width = box.maximum[j] - box.minimum[j];
      a[i * d + j] = box.minimum[j] + width * campaign::scrambled_sobol(i, seed, int(j));
      b[i * d + j] = box.minimum[j] + width * campaign::scrambled_sobol(i, seed, int(d + j));
    }
  function(a, values);
  double mean = 0, squares = 0;
  for (const double value : values) mean += value / samples;
  for (const double value : values) squares += (value - mean) * (value - mean) / samples;
  TotalIndices result{squares, std::vector<double>(d, 0.0)};
  if (!(squares > 0)) return result;
  for (std::size_t j = 0; j < d; ++j) {
    std::vector<double> mixed = a;
    for (std::uint32_t i = 0; i < samples; ++i) mixed[i * d + j] = b[i * d + j];
    function(mixed, changed);
    for (std::uint32_t i = 0; i < samples; ++i)
      result.total[j] += (values[i] - changed[i]) * (values[i] - changed[i]) / (2.0 * samples * squares);
  }
  return result;
}

std::vector<double> permutation_importance(const ManyValues& function, std::span<const double> points,
                                           std::size_t dimensions, std::span<const double> truth, int repeats,
                                           std::uint64_t seed) {
  const double base = mean_squared_error(function, points, truth);
  std::vector<double> importance(dimensions, 0.0);
  for (std::size_t j = 0; j < dimensions; ++j)
    for (int repeat = 0; repeat < repeats; ++repeat) {
      std::vector<double> shuffled(points.begin(), points.end());
      shuffle_column(shuffled, dimensions, j, seed,
                     kShuffleStream + j * std::uint64_t(repeats) + std::uint64_t(repeat));
      importance[j] += (mean_squared_error(function, shuffled, truth) - base) / repeats;
    }
  return importance;
}

std::vector<VariableImportance> model_importance(const Predictor& predictor, const campaign::Dataset& dataset,
                                                 std::uint64_t seed) {
  constexpr std::uint32_t kSamples = 2048;
  constexpr int kShuffles = 5;
  const learning::Model& model = predictor.model();
  std::vector<std::size_t> varied;
  InputBox box;
  for (std::size_t i = 0; i < campaign::contract().variables.size(); ++i) {
    if (!(model.sampled_lower[i] < model.sampled_upper[i])) continue;
    varied.push_back(i);
    box.minimum.push_back(model.sampled_lower[i]);
    box.maximum.push_back(model.sampled_upper[i]);
  }
  const std::size_t dimensions = varied.size(), all = campaign::contract().variables.size();
  const ManyValues p_go = [&](std::span<const double> points, std::span<double> values) {
    std::vector<double> whole(values.size() * all);
    for (std::size_t row = 0; row < values.size(); ++row) {
      for (std::size_t i = 0; i < all; ++i) whole[row * all + i] = model.sampled_lower[i];
      for (std::size_t j = 0; j < dimensions; ++j) whole[row * all + varied[j]] = points[row * dimensions + j];
    }
    predictor.p_go(whole, values);
  };
  std::vector<double> points, truth;
  for (const campaign::TrialRecord& record : dataset.records) {
    if (record.verdict == campaign::Verdict::unknown) continue;
    for (const std::size_t i : varied) points.push_back(record.point.variables[i]);
    truth.push_back(campaign::passes(record.verdict) ? 1 : 0);
  }
  if (truth.empty()) throw InputError("the dataset has no valid trial; importance needs at least one");
  const TotalIndices indices = sobol_total_indices(p_go, box, kSamples, seed);
  const std::vector<double> permutation = permutation_importance(p_go, points, dimensions, truth, kShuffles, seed);
  std::vector<VariableImportance> result;
  for (std::size_t j = 0; j < dimensions; ++j)
    result.push_back({campaign::contract().variables[varied[j]].name, indices.total[j], permutation[j]});
  std::stable_sort(result.begin(), result.end(),
                   [](const auto& a, const auto& b) { return a.total_index > b.total_index; });
  return result;
}

std::string to_text(const std::vector<VariableImportance>& importances) {
  std::string text = line("%-18s %18s %24s\n", "variable", "Sobol' total index", "Brier score if shuffled");
  for (const VariableImportance& v : importances)
    text += line("%-18s %18.3f %+24.4f\n", v.name.c_str(), v.total_index, v.permutation);
  return text;
}

Json to_json(const std::vector<VariableImportance>& importances) {
  Json object = Json::object();
  for (const VariableImportance& v : importances) {
    object[v.name]["sobol_total_index"] = v.total_index;
    object[v.name]["brier_increase"] = v.permutation;
  }
  return object;
}

}  // namespace gonogo::outcome
