// A machine over any variables, as scikit-learn's estimators need it.
#include <nanobind/stl/string.h>

#include <cmath>

#include "learning/model/posterior.h"
#include "python/src/arrays.h"
#include "python/src/calls.h"
#include "python/src/module.h"

namespace nb = nanobind;

namespace gonogo::python {
namespace {

class Machine {
 public:
  /// layout: JSON. weight [visible, hidden], visible_bias [visible], hidden_bias [hidden].
  Machine(const std::string& layout, const ArrayIn<double, 2>& weight, const ArrayIn<double, 1>& visible_bias,
          const ArrayIn<double, 1>& hidden_bias)
      : layout_(learning::VisibleLayout::from_json(Json::parse(layout, "machine"), "machine")),
        posterior_(layout_, weights_of(weight, visible_bias, hidden_bias)) {}

  /// P(class) [row, class]; NaN is unknown and summed out.
  Array<double> probabilities(const ArrayIn<double, 2>& rows) const {
    const std::size_t count = rows.shape(0), width = rows.shape(1), classes = layout_.outcome_count();
    if (width != layout_.variable_count())
      throw InputError("machine: " + std::to_string(width) + " variables given, " +
                       std::to_string(layout_.variable_count()) + " needed");
    std::vector<double> result(count * classes);
    long_call([&] {
      for (std::size_t n = 0; n < count; ++n) {
        stop_if_cancelled();
        answer(std::span(rows.data() + n * width, width), std::span(result).subspan(n * classes, classes));
      }
    });
    return array_of(std::move(result), {count, classes});
  }

 private:
  static learning::RbmWeights weights_of(const ArrayIn<double, 2>& weight, const ArrayIn<double, 1>& visible_bias,
                                         const ArrayIn<double, 1>& hidden_bias) {
    learning::RbmWeights w;
    w.visible_count = visible_bias.size();
    w.hidden_count = hidden_bias.size();
    if (weight.shape(0) != w.visible_count || weight.shape(1) != w.hidden_count)
      throw InputError("machine: weights and biases differ in size");
    w.weight.assign(weight.data(), weight.data() + weight.size());
    w.visible_bias = vector_of(visible_bias);
    w.hidden_bias = vector_of(hidden_bias);
    return w;
  }

  void answer(std::span<const double> row, std::span<double> result) const {
    bool known = true;
    for (double x : row) known = known && !std::isnan(x);
    if (known) return posterior_(row, result);
    const std::vector<double> p = posterior_.marginal(row).probability;
    std::copy(p.begin(), p.end(), result.begin());
  }

  learning::VisibleLayout layout_;
  learning::Posterior posterior_;
};

}  // namespace

void bind_machine(nb::module_& m) {
  using namespace nb::literals;
  nb::class_<Machine>(m, "Machine", "A restricted Boltzmann machine over any variables.")
      .def(nb::init<const std::string&, const ArrayIn<double, 2>&, const ArrayIn<double, 1>&,
                    const ArrayIn<double, 1>&>(),
           "layout"_a, "weight"_a, "visible_bias"_a, "hidden_bias"_a)
      .def("probabilities", &Machine::probabilities, "rows"_a, "P(class) [row, class]; NaN is unknown.");
}

}  // namespace gonogo::python
