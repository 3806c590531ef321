// Handwritten digits of 8 x 8 binary pixels as tables, and the settings with which they are learned.
#pragma once
#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "learning/rbm/train.h"

namespace gonogo::learning {

struct Digits {
  std::size_t width = 0;       // bits of a row
  std::vector<double> pixels;  // [row x width] of {0, 1}
  std::vector<std::size_t> label;
};

/// Lines of bits and a label.
inline Digits read_digits(const std::string& path) {
  std::ifstream in(path);
  Digits digits;
  for (std::string line; std::getline(in, line);) {
    std::istringstream cells(line);
    std::vector<double> row{std::istream_iterator<double>(cells), std::istream_iterator<double>()};
    if (row.size() < 2 || (digits.width > 0 && row.size() != digits.width + 1))
      throw InputError(path + ": a line that is not bits and a label");
    digits.width = row.size() - 1;
    digits.label.push_back(std::size_t(row.back()));
    digits.pixels.insert(digits.pixels.end(), row.begin(), row.end() - 1);
  }
  if (digits.label.empty()) throw InputError(path + ": no rows of bits and a label");
  return digits;
}

/// visible hidden, then a, b and W row by row.
inline RbmWeights read_machine(const std::string& path) {
  std::ifstream in(path);
  std::size_t visible = 0, hidden = 0;
  in >> visible >> hidden;
  RbmWeights machine = RbmWeights::zeros(visible, hidden);
  for (auto* part : {&machine.visible_bias, &machine.hidden_bias, &machine.weight})
    for (double& x : *part) in >> x;
  if (!in) throw InputError(path + ": not a machine");
  return machine;
}

inline VisibleLayout pixel_layout(std::size_t width, bool labels) {
  std::vector<Encoder> encoders;
  for (std::size_t i = 0; i < width; ++i)
    encoders.push_back(Encoder::by_range("pixel" + std::to_string(i), "-", Code::thermometer, 2, 0, 1));
  std::vector<std::string> outcomes;
  for (int y = 0; labels && y < 10; ++y) outcomes.push_back(std::to_string(y));
  return VisibleLayout(std::move(encoders), std::move(outcomes));
}

inline TrainingTable digit_table(const Digits& digits, bool labels) {
  TrainingTable table;
  table.variable_count = digits.width;
  for (double x : digits.pixels) table.variables.push_back(0.25 + 0.5 * x);
  for (std::size_t n = 0; n < digits.label.size(); ++n) {
    table.outcome.push_back(labels ? digits.label[n] : 0);
    table.weight.push_back(1);
    table.group.push_back(n);
  }
  return table;
}

inline TrainingSettings density_settings(std::size_t hidden) {
  TrainingSettings settings;
  settings.hidden = hidden;
  settings.discriminative = 0;
  settings.generative = 1;
  settings.weight_decay = 10;
  settings.batch = 50;
  settings.epochs = settings.report_every = 200;
  settings.learning_rate = 0.005;
  settings.final_learning_rate = 0.02;
  settings.centred = true;
  settings.chains = 100;
  settings.sweeps = 2;
  return settings;
}

inline TrainingSettings hybrid_settings() {
  TrainingSettings settings;
  settings.hidden = 300;
  settings.generative = 0.01;
  settings.weight_decay = 0.3;
  settings.batch = 50;
  settings.epochs = settings.report_every = 12;
  settings.learning_rate = 0.01;
  settings.final_learning_rate = 0.02;
  settings.centred = true;
  settings.chains = 50;
  settings.sweeps = 2;
  return settings;
}

inline double label_accuracy(const RbmWeights& machine, const Digits& digits) {
  const Posterior posterior(pixel_layout(digits.width, true), machine);
  const TrainingTable table = digit_table(digits, true);
  std::vector<double> p(10);
  double right = 0;
  for (std::size_t n = 0; n < table.row_count(); ++n) {
    posterior(table.row(n), p);
    right += std::size_t(std::max_element(p.begin(), p.end()) - p.begin()) == digits.label[n];
  }
  return right / double(table.row_count());
}

}  // namespace gonogo::learning
