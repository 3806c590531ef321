#include "pipeline/learn/training/contract_model.h"

#include "base/error.h"
#include "pipeline/campaign/study/task_variables.h"

namespace gonogo::learn {
namespace {

bool knows(const learning::VisibleLayout& layout, const std::string& variable) {
  for (const learning::Encoder& encoder : layout.encoders())
    if (encoder.name() == variable) return true;
  return false;
}

/// Puts the variable at place `v`, where all trials have 0 of it.
void add_variable(learning::Model& model, const campaign::Variable& variable, std::size_t v) {
  const auto at = [v](auto& list) { return list.begin() + std::ptrdiff_t(v); };
  std::vector<learning::Encoder> encoders = model.layout.encoders();
  encoders.insert(at(encoders),
                  learning::Encoder::by_range(variable.name, variable.unit, learning::Code::thermometer, 1, 0, 0));
  const std::size_t before = model.layout.variable_count();
  model.layout = learning::VisibleLayout(std::move(encoders), model.layout.outcomes());
  model.sampled_lower.insert(at(model.sampled_lower), 0);
  model.sampled_upper.insert(at(model.sampled_upper), 0);
  if (!model.input_prior.empty()) model.input_prior.insert(at(model.input_prior), {1.0});
  std::vector<double> points;
  for (std::size_t n = 0; n < model.training_outcomes.size(); ++n) {
    const auto row = model.training_points.begin() + std::ptrdiff_t(n * before);
    points.insert(points.end(), row, row + std::ptrdiff_t(v));
    points.push_back(0);
    points.insert(points.end(), row + std::ptrdiff_t(v), row + std::ptrdiff_t(before));
  }
  model.training_points = std::move(points);
}

}  // namespace

learning::Model read_contract_model(const std::filesystem::path& file) {
  learning::Model model = learning::read_model(file);
  for (std::size_t v = 0; v < campaign::contract().variables.size(); ++v) {
    const campaign::Variable& variable = campaign::contract().variables[v];
    if (campaign::is_task_variable(variable) && v <= model.layout.variable_count() &&
        !knows(model.layout, variable.name))
      add_variable(model, variable, v);
  }
  check_contract(model, file.string());
  return model;
}

void check_contract(const learning::Model& model, const std::string& source) {
  bool same = model.layout.variable_count() == campaign::contract().variables.size() &&
              model.layout.outcome_count() == campaign::contract().outcomes.size();
  for (std::size_t v = 0; same && v < campaign::contract().variables.size(); ++v)
    same = model.layout.encoders()[v].name() == campaign::contract().variables[v].name;
  for (std::size_t y = 0; same && y < campaign::contract().outcomes.size(); ++y)
    same = model.layout.outcomes()[y] == campaign::contract().outcomes[y].name;
  if (!same)
    throw InputError(source +
                     ": was trained with other variables or outcomes than this program's contract; train again");
}

}  // namespace gonogo::learn
