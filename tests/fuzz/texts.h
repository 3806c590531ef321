// All that is read from a file, as text.
#pragma once
#include <string>
#include <vector>

#include "learning/model/model.h"
#include "learning/qubo/problem.h"

namespace gonogo::fuzz {

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)) + "|";
}

inline std::string text_of(const learning::Problem& problem) {
  std::string text =
      learning::vartype_name(problem.vartype) + bytes_of(problem.linear) + bytes_of(std::vector{problem.offset});
  for (const learning::Label& label : problem.labels) text += learning::label_text(label) + ",";
  for (const learning::Coupling& c : problem.couplings)
    text += std::to_string(c.a) + "-" + std::to_string(c.b) + bytes_of(std::vector{c.value});
  return text;
}

inline std::string text_of(const learning::Model& m) {
  std::string text = m.layout.to_json().dump() + m.provenance.dump() + bytes_of(m.weights.weight) +
                     bytes_of(m.weights.visible_bias) + bytes_of(m.weights.hidden_bias) + bytes_of(m.sampled_lower) +
                     bytes_of(m.sampled_upper) + bytes_of(m.training_points) + bytes_of(m.training_outcomes) +
                     bytes_of(m.training_weights) + bytes_of(m.log) + bytes_of(std::vector{m.calibration_power});
  for (const auto& variable : m.input_prior) text += bytes_of(variable);
  return text;
}

}  // namespace gonogo::fuzz
