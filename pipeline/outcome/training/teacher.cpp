#include "pipeline/outcome/training/teacher.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "base/error.h"
#include "base/math/random.h"
#include "base/parallel/host_loop.h"
#include "learning/model/model.h"
#include "learning/rbm/regression/fit_files.h"
#include "pipeline/campaign/design/sobol.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/outcome/training_data.h"

namespace gonogo::outcome {

TeacherShare teacher_share(const LearningSettings& settings) {
  const double weight = settings.teacher.value_or(10);
  const bool is_box = settings.training.negative == learning::NegativePhaseKind::code_words && settings.importance == 1;
  return {weight, is_box ? weight / (1 + weight) : 0};
}

bool samples_vehicles(const std::vector<double>& lower, const std::vector<double>& upper) {
  const std::vector<campaign::Variable>& variables = campaign::contract().variables;
  for (std::size_t v = 0; v < lower.size(); ++v)
    if (campaign::is_family_variable(variables[v]) && lower[v] < upper[v]) return true;
  return false;
}

namespace {

/// Rows of other trials at the own fidelity, if they drove vehicles of a family whose numbers the box samples.
std::vector<std::size_t> family_rows(const OtherTrials& others, const std::vector<double>& lower,
                                     const std::vector<double>& upper) {
  const bool is_family = samples_vehicles(lower, upper);
  std::vector<std::size_t> rows;
  for (std::size_t n = 0; is_family && n < others.table.row_count(); ++n) {
    const std::span<const double> fidelity = others.table.row(n).subspan(lower.size());
    if (std::equal(fidelity.begin(), fidelity.end(), others.own.begin(), others.own.end())) rows.push_back(n);
  }
  return rows;
}

/// The numbers of that row's vehicle, moved by a share of the box with where the point lies in it.
void put_vehicle(std::span<double> point, std::span<const double> row, const std::vector<double>& lower,
                 const std::vector<double>& upper) {
  constexpr double kSpread = 0.05;  // of the box; docs/log/learning.md says what 0.3 did
  for (std::size_t v = 0; v < point.size(); ++v)
    if (campaign::is_family_variable(campaign::contract().variables[v])) {
      const double middle = (lower[v] + upper[v]) / 2;
      point[v] = std::clamp(row[v] + kSpread * (point[v] - middle), lower[v], upper[v]);
    }
}

}  // namespace

TaughtPoints taught_points(const std::vector<double>& lower, const std::vector<double>& upper, std::size_t count,
                           std::uint64_t seed, const OtherTrials& others) {
  constexpr std::uint64_t kVehicles = 0x7665686963;  // stream of random numbers
  const std::vector<std::size_t> rows = family_rows(others, lower, upper);
  TaughtPoints points{.values = {}, .joint_every = rows.empty() ? std::size_t(1) : std::size_t(2)};
  for (std::size_t k = 0; k < count; ++k) {
    // Each kind of point has a sequence of its own: those of even number in a Sobol' sequence fill a corner alone.
    const auto number = std::uint32_t(k / points.joint_every);
    const std::uint64_t scramble = k % points.joint_every == 0 ? seed : random_bits(seed, kVehicles, 0);
    for (std::size_t v = 0; v < lower.size(); ++v)
      points.values.push_back(lower[v] + (upper[v] - lower[v]) * campaign::scrambled_sobol(number, scramble, int(v)));
    if (k % points.joint_every == 0) continue;
    const std::size_t row = rows[std::size_t(random_unit(seed, kVehicles, k) * double(rows.size()))];
    put_vehicle(std::span(points.values).last(lower.size()), others.table.row(row), lower, upper);
  }
  return points;
}

namespace {

/// Rows with more inputs at their end. points: [row x width]; added: [row x count]
std::vector<double> with_inputs(const std::vector<double>& points, std::size_t width, const std::vector<double>& added,
                                std::size_t count) {
  std::vector<double> result;
  auto more = added.begin();
  for (auto row = points.begin(); row != points.end(); row += std::ptrdiff_t(width), more += std::ptrdiff_t(count)) {
    result.insert(result.end(), row, row + std::ptrdiff_t(width));
    result.insert(result.end(), more, more + std::ptrdiff_t(count));
  }
  return result;
}

/// The first `variables` of every row.
std::vector<double> variables_of(const std::vector<double>& points, std::size_t width, std::size_t variables) {
  std::vector<double> result;
  for (auto row = points.begin(); row != points.end(); row += std::ptrdiff_t(width))
    result.insert(result.end(), row, row + std::ptrdiff_t(variables));
  return result;
}

/// Log odds of a forecast, which is never quite sure [nat].
std::vector<double> log_odds(const Forecast& forecast, const std::vector<double>& points) {
  constexpr double kDoubt = 0.005;
  std::vector<double> result = forecast.p_go(points);
  for (double& p : result) {
    p = std::clamp(p, kDoubt, 1 - kDoubt);
    p = std::log(p / (1 - p));
  }
  return result;
}

/// What a family says of points. Empty without a forecast.
struct FamilyAnswers {
  std::vector<double> odds;    // of its model [nat]
  std::vector<double> shares;  // of the commanded speed, by its trials; empty where these are not known
};

/// points: [x variables]
FamilyAnswers family_answers(const OtherTrials& known, const std::vector<double>& points, std::size_t variables) {
  if (!known.forecast) return {};
  FamilyAnswers family{log_odds(*known.forecast, points), {}};
  if (known.family_speed)
    family.shares = (*known.family_speed)(with_input(known.forecast->in_family(points), variables, size_across));
  return family;
}

/// What the processes see beside the variables. points: [row x width]; family_odds: FamilyAnswers::odds
std::vector<double> with_knowledge(const OtherTrials& known, std::vector<double> points, std::size_t width,
                                   std::size_t variables, const std::vector<double>& family_odds) {
  if (known.composed) {
    points = with_inputs(points, width, known.composed->inputs(variables_of(points, width, variables)),
                         ComposedVehicle::kInputs);
    width += ComposedVehicle::kInputs;
  }
  return known.forecast ? with_inputs(points, width, family_odds, 1) : points;
}

/// Log odds of every row by the model, beside those that are given. inputs: [row x the model's variables]
std::vector<double> summed_odds(const learning::LogisticModel& model, const std::vector<double>& inputs,
                                const std::vector<double>& given) {
  const std::size_t width = model.mean.size();
  std::vector<double> result;
  for (std::size_t first = 0; first < inputs.size(); first += width)
    result.push_back(model.log_odds(std::span(inputs).subspan(first, width)));
  for (std::size_t k = 0; k < given.size(); ++k) result[k] += given[k];
  return result;
}

/// The rows with these inputs.
learning::TrainingTable with_variables(const learning::TrainingTable& rows, std::vector<double> inputs) {
  learning::TrainingTable result = rows;
  result.variable_count = inputs.size() / rows.row_count();
  result.variables = std::move(inputs);
  return result;
}

// Penalties beside a forecast, on standardised inputs [nat]: few trials move its log odds by some 0.3 along a variable,
// and by some 1 with the speed to expect (docs/log/learning.md).
constexpr double kRidgeOfVariables = 10, kRidgeOfShare = 1, kRidgeOfConstant = 0.3;

/// What a regression adds to the family's log odds: on variables and the size across, and on r where `sees_share`.
learning::LogisticModel fit_correction(const learning::TrainingTable& rows, const std::vector<int>& label,
                                       std::vector<double> inputs, const std::vector<double>& family_odds,
                                       bool sees_share) {
  const learning::TrainingTable table = with_variables(rows, std::move(inputs));
  std::vector<double> ridge(table.variable_count, kRidgeOfVariables);
  if (sees_share) ridge.back() = kRidgeOfShare;
  ridge.push_back(kRidgeOfConstant);
  return learning::fit_logistic(table, label, family_odds, ridge);
}

}  // namespace

Teacher::Teacher(const learning::TrainingTable& rows, const OtherTrials& others) : variables_(rows.variable_count) {
  constexpr double kRidge = 0.1;  // of a and b [nat]
  if (!others.empty()) known_.own = others.own;
  known_.composed = others.composed;
  known_.forecast = others.forecast;
  known_.family_speed = others.family_speed;
  learning::TrainingTable table = with_input(others.joined(rows), size_across);
  const std::vector<int> label = passable_labels(table);
  const std::vector<double> asked = variables_of(table.variables, table.variable_count, variables_);
  const FamilyAnswers family = family_answers(known_, asked, variables_);
  if (known_.forecast)
    correction_ = fit_correction(table, label, with_input(asked, variables_, size_across), family.odds, false);
  table.variables = with_knowledge(known_, std::move(table.variables), table.variable_count, variables_, family.odds);
  table.variable_count = table.variables.size() / table.row_count();
  const learning::GaussianProcessSettings settings{.variances = false};
  plain_ = learning::fit_gaussian_process(table, label, settings, mean(asked, family.odds));
  if (!SpeedShare::can_learn(table)) return;
  SpeedShare share(table, family.shares);
  const std::vector<double> seen_shares = with_share(asked, share.of_rows(table, family.shares));
  learning::LogisticModel passes = known_.forecast
                                       ? fit_correction(table, label, seen_shares, family.odds, true)
                                       : learning::fit_logistic(with_variables(table, seen_shares), label, kRidge);
  learning::GaussianProcessModel rest = learning::fit_gaussian_process(
      table, label, settings, summed_odds(passes, seen_shares, family.odds), plain_.search());
  graded_.emplace(Graded{std::move(share), std::move(passes), std::move(rest)});
}

std::vector<double> Teacher::mean(const std::vector<double>& points, const std::vector<double>& family_odds) const {
  if (!correction_) return {};
  return summed_odds(*correction_, with_input(points, variables_, size_across), family_odds);
}

std::vector<double> Teacher::with_share(const std::vector<double>& points, const std::vector<double>& shares) const {
  if (!known_.forecast) return shares;
  return with_inputs(with_input(points, variables_, size_across), variables_ + 1, shares, 1);
}

std::vector<double> Teacher::operator()(const std::vector<double>& points) const {
  const FamilyAnswers family = family_answers(known_, points, variables_);
  const std::size_t width = variables_ + known_.own.size();
  const std::vector<double> seen = with_knowledge(
      known_, with_input(known_.at_own(points, variables_), width, size_across), width + 1, variables_, family.odds);
  std::vector<double> p = plain_.most_probable(seen, mean(points, family.odds));
  if (!graded_) return p;
  const std::vector<double> inputs = with_share(points, graded_->share(seen, family.shares));
  const std::vector<double> q = graded_->rest.most_probable(seen, summed_odds(graded_->passes, inputs, family.odds));
  for (std::size_t k = 0; k < p.size(); ++k) p[k] = (p[k] + q[k]) / 2;
  return p;
}

std::vector<double> Teacher::of_many(const std::vector<double>& points) const {
  constexpr std::size_t kBlock = 128;  // points
  const std::size_t count = points.size() / variables_;
  std::vector<double> result(count);
  for_each_on_host((count + kBlock - 1) / kBlock, 1, [&](std::size_t block) {
    const std::size_t first = block * kBlock, end = std::min(count, first + kBlock);
    const std::vector<double> p = (*this)(
        {points.begin() + std::ptrdiff_t(first * variables_), points.begin() + std::ptrdiff_t(end * variables_)});
    std::copy(p.begin(), p.end(), result.begin() + std::ptrdiff_t(first));
  });
  return result;
}

void Teacher::write(Hdf5Writer& out) const {
  GONOGO_ASSERT(!known_.forecast);
  const std::string group = kTeacherGroup;
  out.group(group);
  out.attribute(group, "description", "two Gaussian processes that say P(go) beside the machine, which they taught");
  out.array(group + "/fidelity", known_.own);
  learning::write_fit(out, group + "/plain", plain_);
  if (known_.composed) known_.composed->write(out, group + "/composed");
  if (!graded_) return;
  graded_->share.write(out, group + "/graded/share");
  learning::write_fit(out, group + "/graded/passes", graded_->passes);
  learning::write_fit(out, group + "/graded/rest", graded_->rest);
}

Teacher Teacher::read(const std::filesystem::path& file) {
  const Hdf5Reader in(file);
  const std::string group = kTeacherGroup;
  if (!in.has(group)) in.fail("/", "holds no teacher, which answers for single vehicles; train the model again");
  Teacher teacher;
  teacher.variables_ = campaign::contract().variables.size();
  teacher.known_.own = learning::finite_array(in, group + "/fidelity");
  std::size_t inputs = teacher.variables_ + teacher.known_.own.size() + 1;  // and the size across
  if (in.has(group + "/composed")) {
    teacher.known_.composed = std::make_shared<const ComposedVehicle>(ComposedVehicle::read(in, group + "/composed"));
    inputs += ComposedVehicle::kInputs;
  }
  const auto process = [&](const std::string& name) {
    learning::GaussianProcessModel read = learning::read_process(in, group + name);
    if (read.input_count() != inputs)
      in.fail(group + name, "has other inputs than this program's; train the model again");
    return read;
  };
  teacher.plain_ = process("/plain");
  if (!in.has(group + "/graded")) return teacher;
  teacher.graded_.emplace(Graded{SpeedShare::read(in, group + "/graded/share"),
                                 learning::read_logistic(in, group + "/graded/passes"), process("/graded/rest")});
  if (teacher.graded_->share.width() != inputs || teacher.graded_->passes.mean.size() != 1)
    in.fail(group + "/graded", "has other inputs than this program's; train the model again");
  return teacher;
}

std::vector<double> process_baseline(const learning::TrainingTable& rows, const OtherTrials& others,
                                     const std::vector<double>& points) {
  const learning::TrainingTable table = others.joined(rows);
  const OtherTrials own{{}, others.empty() ? std::vector<double>() : others.own, {}};
  return learning::fit_gaussian_process(table, passable_labels(table))
      .probabilities(own.at_own(points, rows.variable_count));
}

std::shared_ptr<const learning::Teaching> teaching(TeacherShare share, TaughtPoints points,
                                                   std::vector<double> probability) {
  return std::make_shared<const learning::Teaching>(learning::Teaching{.weight = share.weight,
                                                                       .points = std::move(points.values),
                                                                       .probability = std::move(probability),
                                                                       .label = passable_outcomes(),
                                                                       .joint_share = share.joint_share,
                                                                       .joint_every = points.joint_every});
}

}  // namespace gonogo::outcome
