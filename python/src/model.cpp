// Trained models, and machines over any variables.
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <cmath>

#include "base/format.h"
#include "learning/model/posterior.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/map/trained_model.h"
#include "pipeline/outcome/answer/infer.h"
#include "python/src/binding.h"

namespace nb = nanobind;

namespace gonogo::python {
namespace {

using Points = ArrayIn<double, 2>;

[[noreturn]] void refuse(const std::vector<campaign::Variable>& variables, std::size_t k, double x) {
  const campaign::Variable& v = variables[k % variables.size()];
  throw InputError("points: row " + std::to_string(k / variables.size()) + ": " + v.name + ": " + line("%g", x) +
                   " lies outside " + line("%g to %g ", v.minimum, v.maximum) + v.unit);
}

std::span<const double> checked(const Points& points) {
  const auto& variables = campaign::contract().variables;
  const std::size_t width = variables.size();
  if (points.shape(1) != width)
    throw InputError("points: " + std::to_string(points.shape(1)) + " columns given, " + std::to_string(width) +
                     " needed, in the order of gonogo.variables()");
  const std::span all(points.data(), points.size());
  for (std::size_t row = 0; row < all.size(); row += width)
    for (std::size_t v = 0; v < width; ++v)
      if (const double x = all[row + v]; !campaign::admits(variables[v], x)) refuse(variables, row + v, x);
  return all;
}

Array<double> p_go(const outcome::Predictor& predictor, const Points& points) {
  std::vector<double> result(points.shape(0));
  long_call([&] { predictor.p_go(checked(points), result); });
  return array_of(std::move(result));
}

Array<double> outcome_probabilities(const outcome::Predictor& predictor, const Points& points) {
  const std::size_t rows = points.shape(0), outcomes = predictor.model().layout.outcome_count();
  std::vector<double> result(rows * outcomes);
  long_call([&] { predictor.outcome_probabilities(checked(points), result); });
  return array_of(std::move(result), {rows, outcomes});
}

/// f(point) for every row.
template <class T, class F>
Array<T> each_row(const Points& points, F&& f) {
  const std::size_t width = points.shape(1);
  std::vector<T> result(points.shape(0));
  long_call([&] {
    const auto all = checked(points);
    for (std::size_t n = 0; n < result.size(); ++n) {
      stop_if_cancelled();
      result[n] = f(all.subspan(n * width, width));
    }
  });
  return array_of(std::move(result));
}

Members answer(const outcome::Predictor& predictor, const Points& point, const std::optional<std::string>& outcome,
               bool reconstruct) {
  outcome::Question question;
  if (outcome) question.outcome = outcome::outcome_named(*outcome);
  question.reconstruct = reconstruct;
  return members_of(long_call([&] {
    const auto all = checked(point);
    question.variables.assign(all.begin(), all.end());
    return outcome::to_json(outcome::answer_question(predictor, question));
  }));
}

}  // namespace

void bind_model(nb::module_& m) {
  m.def(
      "variable_index", [](const std::string& name) { return campaign::contract().variable_index(name); },
      nb::arg("name"), "Position of a variable in a point. Raises InputError that suggests the nearest name.");
  m.def(
      "find_model", [](const std::string& name) { return map::find_model(name).string(); }, nb::arg("name"),
      "Path of a model: a file, a folder that holds model.h5, or the name of a shipped model or of its vehicle.");
  m.def(
      "shipped_models",
      [] {
        std::vector<std::string> names;
        for (const auto& folder : map::shipped_models()) names.push_back(folder.filename().string());
        return names;
      },
      "Names of the models that ship.");
  nb::class_<outcome::Predictor>(m, "Predictor", "A trained model. Points are [n, variable_count], NaN: unknown.")
      .def_static(
          "read", [](const std::string& path) { return long_call([&] { return outcome::Predictor::read(path); }); },
          nb::arg("path"))
      .def("p_go", &p_go, nb::arg("points"), "P(go or slow_go) [n].")
      .def("outcome_probabilities", &outcome_probabilities, nb::arg("points"), "P(outcome) [n, outcome_count].")
      .def(
          "novelty",
          [](const outcome::Predictor& p, const Points& points) {
            return each_row<double>(points, [&](auto point) { return p.novelty(point); });
          },
          nb::arg("points"), "Distance to the nearest trial over the usual distance between trials [n].")
      .def(
          "inside_sampled_box",
          [](const outcome::Predictor& p, const Points& points) {
            return each_row<std::uint8_t>(points, [&](auto point) { return p.inside_sampled_box(point); });
          },
          nb::arg("points"), "1 where all known variables lie in the sampled ranges, otherwise 0 [n].")
      .def("answer", &answer, nb::arg("point"), nb::arg("outcome").none(), nb::arg("reconstruct"),
           "The answer to one point [1, variable_count].")
      .def_prop_ro("sampled_lower", [](const outcome::Predictor& p) { return p.model().sampled_lower; })
      .def_prop_ro("sampled_upper", [](const outcome::Predictor& p) { return p.model().sampled_upper; })
      .def_prop_ro("provenance", [](const outcome::Predictor& p) { return members_of(p.model().provenance); });
}

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
