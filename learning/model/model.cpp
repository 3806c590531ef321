#include "learning/model/model.h"

#include <cmath>

#include "base/error.h"

namespace gonogo::learning {
namespace {

constexpr const char* kFormat = "gonogo/model/3";

std::vector<double> log_column(const std::vector<EpochLog>& log, double EpochLog::*member) {
  std::vector<double> column;
  for (const EpochLog& entry : log) column.push_back(entry.*member);
  return column;
}

void describe(Hdf5Writer& out, const std::string& path, const std::string& unit, const std::string& description) {
  out.attribute(path, "unit", unit);
  out.attribute(path, "description", description);
}

/// What must hold between the parts of a model, whoever made it.
void check_parts(const Hdf5Reader& in, const Model& model) {
  for (std::size_t v = 0; v < model.layout.variable_count(); ++v)
    if (model.sampled_lower[v] > model.sampled_upper[v]) in.fail("sampled/lower", "lies above sampled/upper");
  for (std::int32_t y : model.training_outcomes)
    if (y < 0 || std::size_t(y) >= model.layout.outcome_count())
      in.fail("training/outcomes", "outcome " + std::to_string(y) + " does not exist");
  for (double w : model.training_weights)
    if (!(w > 0)) in.fail("training/weights", "holds a weight that is not above 0");
}

InputPrior read_prior(const Hdf5Reader& in, const VisibleLayout& layout) {
  const std::vector<double> values = in.array<double>("prior/probability");
  InputPrior prior;
  if (values.empty()) return prior;
  std::size_t used = 0;
  for (const Encoder& encoder : layout.encoders()) {
    const std::size_t bins = std::size_t(encoder.bin_count());
    double sum = 0;
    prior.emplace_back();
    for (std::size_t bin = 0; bin < bins && used < values.size(); ++bin, ++used) {
      prior.back().push_back(values[used]);
      sum += values[used] >= 0 ? values[used] : NAN;
    }
    if (!(std::abs(sum - 1) < 1e-9))
      in.fail("prior/probability", "does not sum to 1 over the bins of " + encoder.name());
  }
  if (used != values.size()) in.fail("prior/probability", "holds more numbers than the layout has bins");
  return prior;
}

}  // namespace

void write_model(const std::filesystem::path& path, const Model& model, const std::function<void(Hdf5Writer&)>& more) {
  const std::size_t visible = model.weights.visible_count, hidden = model.weights.hidden_count;
  const std::size_t variables = model.layout.variable_count(), points = model.training_outcomes.size();
  Hdf5Writer out;
  out.attribute("/", "format", kFormat);
  out.text("layout", model.layout.to_json().dump());
  out.attribute("layout", "description", "how variables and outcomes are written on the visible units");
  out.array("machine/weight", model.weights.weight, {visible, hidden});
  describe(out, "machine/weight", "nat", "couplings of visible (rows) and hidden units, E = -a.v - b.h - v'Wh");
  out.array("machine/visible_bias", model.weights.visible_bias);
  describe(out, "machine/visible_bias", "nat", "a");
  out.array("machine/hidden_bias", model.weights.hidden_bias);
  describe(out, "machine/hidden_bias", "nat", "b");
  out.array("sampled/lower", model.sampled_lower);
  describe(out, "sampled/lower", "of the variable", "lower end of the range in which trials were made");
  out.array("sampled/upper", model.sampled_upper);
  describe(out, "sampled/upper", "of the variable", "upper end of the range in which trials were made");
  out.array("training/points", model.training_points, {points, variables});
  describe(out, "training/points", "of the variable", "variables of the trials trained on, NaN where unknown");
  out.array("training/outcomes", model.training_outcomes);
  describe(out, "training/outcomes", "-", "their outcomes, counted from 0 in the order of the layout");
  out.array("training/weights", model.training_weights);
  describe(out, "training/weights", "-", "their weights in training: prior over proposal density, mean 1");
  std::vector<double> prior;
  for (const auto& variable : model.input_prior) prior.insert(prior.end(), variable.begin(), variable.end());
  out.array("prior/probability", prior);
  describe(out, "prior/probability", "-",
           "of every bin of every variable, where it is unknown; empty: the machine's own joint distribution");
  out.array("log/epoch", log_column(model.log, &EpochLog::epoch));
  describe(out, "log/epoch", "-", "passes over the training rows");
  out.array("log/training_loss", log_column(model.log, &EpochLog::training_loss));
  describe(out, "log/training_loss", "nat", "mean -log P(outcome | variables) of training rows");
  out.array("log/held_out_loss", log_column(model.log, &EpochLog::held_out_loss));
  describe(out, "log/held_out_loss", "nat", "the same of held-out rows");
  out.array("calibration/power", std::vector<double>{model.calibration_power});
  describe(out, "calibration/power", "-", "probabilities of outcomes are raised to it and normalised again");
  out.text("provenance", model.provenance.dump());
  if (more) more(out);
  out.save(path);
}

std::vector<double> finite_array(const Hdf5Reader& in, const std::string& path, const std::optional<Shape>& shape) {
  std::vector<double> values = in.array<double>(path, shape);
  for (double x : values)
    if (!std::isfinite(x)) in.fail(path, "holds a value that is not a finite number; train the model again");
  return values;
}

Model read_model(const std::filesystem::path& path) {
  const Hdf5Reader in(path);
  if (!in.has_attribute("/", "format") || in.text_attribute("/", "format") != kFormat)
    in.fail("/", std::string("is not a model of format ") + kFormat + "; make one with gonogo train");
  Model model;
  const std::string source = path.string() + ": layout";
  model.layout = VisibleLayout::from_json(Json::parse(in.text("layout"), source), source);
  const std::size_t visible = model.layout.unit_count(), variables = model.layout.variable_count();
  const Shape hidden_shape = in.shape("machine/hidden_bias");
  if (hidden_shape.size() != 1 || hidden_shape[0] == 0) in.fail("machine/hidden_bias", "must be a list, not empty");
  const std::size_t hidden = hidden_shape[0];
  model.weights = {.visible_count = visible,
                   .hidden_count = hidden,
                   .weight = finite_array(in, "machine/weight", Shape{visible, hidden}),
                   .visible_bias = finite_array(in, "machine/visible_bias", Shape{visible}),
                   .hidden_bias = finite_array(in, "machine/hidden_bias", Shape{hidden})};
  model.sampled_lower = finite_array(in, "sampled/lower", Shape{variables});
  model.sampled_upper = finite_array(in, "sampled/upper", Shape{variables});
  model.training_outcomes = in.array<std::int32_t>("training/outcomes");
  model.training_points = in.array<double>("training/points", Shape{model.training_outcomes.size(), variables});
  model.training_weights = finite_array(in, "training/weights", Shape{model.training_outcomes.size()});
  model.input_prior = read_prior(in, model.layout);
  const auto epoch = in.array<double>("log/epoch");
  const auto training = in.array<double>("log/training_loss", Shape{epoch.size()});
  const auto held_out = in.array<double>("log/held_out_loss", Shape{epoch.size()});
  for (std::size_t k = 0; k < epoch.size(); ++k) model.log.push_back({epoch[k], training[k], held_out[k]});
  model.calibration_power = finite_array(in, "calibration/power", Shape{1})[0];
  if (!(model.calibration_power > 0)) in.fail("calibration/power", "must be above 0");
  model.provenance = Json::parse(in.text("provenance"), path.string() + ": provenance");
  check_parts(in, model);
  return model;
}

}  // namespace gonogo::learning
