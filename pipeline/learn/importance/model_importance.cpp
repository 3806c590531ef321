#include "pipeline/learn/importance/model_importance.h"

#include <algorithm>

#include "base/error.h"
#include "base/line.h"
#include "pipeline/campaign/dataset/summary.h"
#include "pipeline/learn/importance/importance.h"

namespace gonogo::learn {
namespace {

constexpr std::uint32_t kSamples = 2048;
constexpr int kShuffles = 5;

}  // namespace

std::vector<VariableImportance> model_importance(const Predictor& predictor, const campaign::Dataset& dataset,
                                                 std::uint64_t seed) {
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

}  // namespace gonogo::learn
