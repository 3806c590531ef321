#include "learning/rbm/words/teaching.h"

#include <cmath>
#include <string>

#include "base/error.h"

namespace gonogo::learning {

void check_teaching(const VisibleLayout& layout, const Teaching& teaching) {
  const std::size_t count = teaching.probability.size();
  if (count == 0 || teaching.points.size() != count * layout.variable_count() ||
      teaching.label.size() != layout.outcome_count())
    throw InputError("teacher: its points, probabilities and classes do not match the layout");
  for (double p : teaching.probability)
    if (!(p >= 0 && p <= 1)) throw InputError("teacher: " + std::to_string(p) + " is no probability");
  std::size_t ones = 0;
  for (int c : teaching.label) ones += c != 0;
  if (ones == 0 || ones == teaching.label.size())
    throw InputError("teacher: both classes need an outcome; the layout has those of one class only");
}

std::vector<std::size_t> points_in_box(const Teaching& teaching, const TrainingTable& table) {
  const std::size_t variables = table.variable_count;
  std::vector<double> low(variables, INFINITY), high(variables, -INFINITY);
  for (std::size_t n = 0; n < table.row_count(); ++n)
    for (std::size_t v = 0; v < variables; ++v) {
      low[v] = std::fmin(low[v], table.row(n)[v]);
      high[v] = std::fmax(high[v], table.row(n)[v]);
    }
  std::vector<std::size_t> inside;
  for (std::size_t k = 0; k < teaching.probability.size(); k += teaching.joint_every) {
    bool is_inside = true;
    for (std::size_t v = 0; v < variables; ++v) {
      const double x = teaching.points[k * variables + v];
      is_inside = is_inside && (low[v] > high[v] || (x >= low[v] && x <= high[v]));
    }
    if (is_inside) inside.push_back(k);
  }
  return inside;
}

}  // namespace gonogo::learning
