// gonogo._train: training and evaluation. The one module that loads LibTorch.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "learning/rbm/train.h"
#include "pipeline/map/family_answers.h"
#include "pipeline/outcome/evaluation/evaluate_model.h"
#include "pipeline/outcome/training/train_model.h"
#include "python/src/binding.h"

namespace nb = nanobind;

namespace gonogo::python {
namespace {

std::vector<std::filesystem::path> paths(const std::vector<std::string>& files) { return {files.begin(), files.end()}; }

/// `study`: JSON file with sections learning and design, or "". `learning`: JSON text of the section, wins over it.
/// `family`: model of the vehicle's family, "" for the one that ships. `vehicles`: datasets that shift a family's odds.
Members train(const std::vector<std::string>& datasets, const std::string& out, const std::string& study,
              const std::string& learning, std::optional<std::uint64_t> seed, std::size_t hold_out,
              const std::optional<std::string>& family, const std::vector<std::string>& vehicles) {
  return members_of(long_call([&] {
    const std::vector<std::filesystem::path> files = outcome::finest_first(paths(datasets));
    outcome::TrainRequest request{
        .dataset = files.front(), .model = out, .hold_out = hold_out, .others = {files.begin() + 1, files.end()}};
    outcome::take_study(request, study, seed);
    if (!learning.empty()) request.learning = Config::parse(learning, "learning");
    if (family) request.forecast = map::family_forecast(*family, request.dataset);
    request.vehicles = map::vehicle_trials(request.dataset, request.design, paths(vehicles));
    return outcome::to_json(outcome::train_model(request));
  }));
}

struct Bins {
  int count;
  std::string code;
};

learning::VisibleLayout layout_of(const ArrayIn<double, 2>& rows, const std::vector<std::string>& classes,
                                  const Bins& bins) {
  std::vector<learning::Encoder> encoders;
  for (std::size_t v = 0; v < rows.shape(1); ++v) {
    std::vector<double> column;
    for (std::size_t n = 0; n < rows.shape(0); ++n) column.push_back(rows.data()[n * rows.shape(1) + v]);
    const std::string name = "x" + std::to_string(v);
    encoders.push_back(
        learning::Encoder::by_quantile(name, "1", learning::code_from_name(bins.code), bins.count, column));
  }
  return {std::move(encoders), classes};
}

/// JSON of the layout, weights [visible, hidden], biases of visible and hidden units.
using Fitted = std::tuple<std::string, Array<double>, Array<double>, Array<double>>;

/// rows [row, variable], outcome [row]: position in `classes`, weight [row].
Fitted fit_machine(const ArrayIn<double, 2>& rows, const ArrayIn<std::int64_t, 1>& outcome,
                   const ArrayIn<double, 1>& weight, const std::vector<std::string>& classes, const Bins& bins,
                   const learning::TrainingSettings& settings) {
  learning::VisibleLayout layout;
  learning::TrainingResult trained;
  long_call([&] {
    layout = layout_of(rows, classes, bins);
    learning::TrainingTable table;
    table.variable_count = rows.shape(1);
    table.variables.assign(rows.data(), rows.data() + rows.size());
    table.outcome.assign(outcome.data(), outcome.data() + outcome.size());
    table.weight = vector_of(weight);
    for (std::size_t n = 0; n < rows.shape(0); ++n) table.group.push_back(n);
    trained = learning::train_rbm(layout, table, settings, *learning::make_sampler("block_gibbs"));
  });
  learning::RbmWeights& w = trained.weights;
  const std::size_t visible = w.visible_count, hidden = w.hidden_count;
  return {layout.to_json().dump(), array_of(std::move(w.weight), {visible, hidden}),
          array_of(std::move(w.visible_bias)), array_of(std::move(w.hidden_bias))};
}

Fitted fit(const ArrayIn<double, 2>& rows, const ArrayIn<std::int64_t, 1>& outcome, const ArrayIn<double, 1>& weight,
           const std::vector<std::string>& classes, int bins, const std::string& code, std::size_t hidden,
           std::size_t epochs, double learning_rate, double weight_decay, double generative, std::uint64_t seed) {
  learning::TrainingSettings settings;
  settings.hidden = hidden;
  settings.epochs = epochs;
  settings.report_every = epochs;
  settings.learning_rate = learning_rate;
  settings.weight_decay = weight_decay;
  settings.generative = generative;
  settings.seed = seed;
  return fit_machine(rows, outcome, weight, classes, {bins, code}, settings);
}

Members evaluate(const std::string& model, const std::string& dataset) {
  return members_of(long_call([&] {
    const map::TrainedModel trained = map::read_trained_model(model);
    const map::AnsweredTrials asked = map::answer_trials(trained, dataset);
    return outcome::to_json(outcome::evaluate_model(*asked.predictor, asked.trials, dataset));
  }));
}

}  // namespace
}  // namespace gonogo::python

NB_MODULE(_train, m) {
  using namespace gonogo;
  using namespace nb::literals;
  m.doc() = "Training and evaluation. Use the package gonogo; names here may change.";
  python::raise_errors_of_core();
  m.def("train", &python::train, "datasets"_a, "out"_a, "study"_a, "learning"_a, "seed"_a.none(), "hold_out"_a,
        "family"_a.none(), "vehicles"_a, "Trains and writes a model. Returns the report.");
  m.def("fit", &python::fit, "rows"_a, "outcome"_a, "weight"_a, "classes"_a, "bins"_a, "code"_a, "hidden"_a, "epochs"_a,
        "learning_rate"_a, "weight_decay"_a, "generative"_a, "seed"_a,
        "Trains a machine over any variables. Returns JSON of its layout, weights, visible and hidden biases.");
  m.def("evaluate", &python::evaluate, "model"_a, "dataset"_a, "Scores a model on a held-out set. Returns the report.");
}
