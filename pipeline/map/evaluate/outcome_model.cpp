#include "pipeline/map/evaluate/outcome_model.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace gonogo::map {

namespace {

constexpr std::size_t kFewestTrials = 12;

/// Symmetric positive definite matrix, n x n.
struct Normal {
  std::size_t n;
  std::vector<double> value;
  double& at(std::size_t i, std::size_t j) { return value[i * n + j]; }
};

/// Inverse by Gauss-Jordan without pivoting, which such a matrix does not need.
Normal inverse_of(Normal a) {
  Normal b{a.n, std::vector<double>(a.n * a.n, 0.0)};
  for (std::size_t i = 0; i < a.n; ++i) b.at(i, i) = 1;
  for (std::size_t k = 0; k < a.n; ++k) {
    const double pivot = a.at(k, k);
    for (std::size_t j = 0; j < a.n; ++j) a.at(k, j) /= pivot, b.at(k, j) /= pivot;
    for (std::size_t i = 0; i < a.n; ++i) {
      if (i == k) continue;
      const double factor = a.at(i, k);
      for (std::size_t j = 0; j < a.n; ++j) a.at(i, j) -= factor * a.at(k, j), b.at(i, j) -= factor * b.at(k, j);
    }
  }
  return b;
}

struct Rows {
  std::size_t count = 0, features = 0;
  std::vector<double> feature;        // [count x features], the first one is 1
  std::vector<double> value;          // [count]
  std::vector<std::size_t> variable;  // that vary, in the order of their pairs of features
  const double* row(std::size_t i) const { return &feature[i * features]; }
};

struct Solution {
  std::vector<double> coefficient;
  double leave_one_out = std::numeric_limits<double>::infinity();  // rmse
};

double dot(const double* a, const double* b, std::size_t n) {
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

/// Ridge on all features but the constant. A residual left out is r / (1 - h), h its leverage.
Solution ridge(const Rows& rows, double strength) {
  const std::size_t n = rows.features;
  Normal normal{n, std::vector<double>(n * n, 0.0)};
  std::vector<double> right(n, 0.0);
  for (std::size_t i = 0; i < rows.count; ++i)
    for (std::size_t a = 0; a < n; ++a) {
      right[a] += rows.row(i)[a] * rows.value[i];
      for (std::size_t b = 0; b < n; ++b) normal.at(a, b) += rows.row(i)[a] * rows.row(i)[b];
    }
  for (std::size_t a = 1; a < n; ++a) normal.at(a, a) += strength * double(rows.count);
  const Normal inverse = inverse_of(normal);
  Solution solution;
  for (std::size_t a = 0; a < n; ++a) solution.coefficient.push_back(dot(&inverse.value[a * n], right.data(), n));
  double sum = 0;
  for (std::size_t i = 0; i < rows.count; ++i) {
    double leverage = 0;
    for (std::size_t a = 0; a < n; ++a) leverage += rows.row(i)[a] * dot(&inverse.value[a * n], rows.row(i), n);
    const double left_out =
        (rows.value[i] - dot(rows.row(i), solution.coefficient.data(), n)) / std::max(1e-9, 1 - leverage);
    sum += left_out * left_out;
  }
  solution.leave_one_out = std::sqrt(sum / double(rows.count));
  return solution;
}

/// Scaling of the variables, and the means that stand in for unknown ones.
void scale(MeasureFit& fit, std::span<const double> points, const std::vector<std::size_t>& kept, std::size_t width) {
  fit.middle.assign(width, 0.0);
  fit.half_width = fit.linear = fit.quadratic = fit.mean_z = fit.mean_z2 = fit.middle;
  for (std::size_t v = 0; v < width; ++v) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const std::size_t i : kept) {
      low = std::min(low, points[i * width + v]);
      high = std::max(high, points[i * width + v]);
    }
    fit.middle[v] = (low + high) / 2;
    fit.half_width[v] = high > low ? (high - low) / 2 : 0;
    if (!(fit.half_width[v] > 0)) continue;
    for (const std::size_t i : kept) {
      const double z = (points[i * width + v] - fit.middle[v]) / fit.half_width[v];
      fit.mean_z[v] += z / double(kept.size());
      fit.mean_z2[v] += z * z / double(kept.size());
    }
  }
}

Rows make_rows(const MeasureFit& fit, std::span<const double> points, std::span<const double> value,
               const std::vector<std::size_t>& kept) {
  const std::size_t width = fit.middle.size();
  Rows rows;
  for (std::size_t v = 0; v < width; ++v)
    if (fit.half_width[v] > 0) rows.variable.push_back(v);
  rows.count = kept.size();
  rows.features = 1 + 2 * rows.variable.size();
  for (const std::size_t i : kept) {
    rows.feature.push_back(1);
    for (const std::size_t v : rows.variable) {
      const double z = (points[i * width + v] - fit.middle[v]) / fit.half_width[v];
      rows.feature.push_back(z);
      rows.feature.push_back(z * z);
    }
    rows.value.push_back(value[i]);
  }
  return rows;
}

void describe_values(MeasureFit& fit, const Rows& rows) {
  double mean = 0, square = 0;
  for (const double x : rows.value) mean += x / double(rows.count);
  for (const double x : rows.value) square += (x - mean) * (x - mean) / double(rows.count);
  fit.constant = mean;
  fit.spread = std::sqrt(square);
  fit.error = fit.spread * double(rows.count) / std::max(1.0, double(rows.count) - 1);  // of the mean, left out
  fit.lowest = *std::min_element(rows.value.begin(), rows.value.end());
  fit.highest = *std::max_element(rows.value.begin(), rows.value.end());
}

}  // namespace

double MeasureFit::value(std::span<const double> variables) const {
  double sum = constant;
  for (std::size_t v = 0; v < middle.size(); ++v) {
    if (!(half_width[v] > 0)) continue;
    const bool known = !std::isnan(variables[v]);
    const double z = (variables[v] - middle[v]) / half_width[v];
    sum += linear[v] * (known ? z : mean_z[v]) + quadratic[v] * (known ? z * z : mean_z2[v]);
  }
  return sum;
}

MeasureFit fit_measure(std::string name, std::string unit, std::span<const double> points,
                       std::span<const double> value) {
  const std::size_t width = campaign::contract().variables.size();
  MeasureFit fit;
  fit.name = std::move(name);
  fit.unit = std::move(unit);
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < value.size(); ++i)
    if (std::isfinite(value[i])) kept.push_back(i);
  fit.trials = kept.size();
  fit.middle.assign(width, 0.0);
  fit.half_width = fit.linear = fit.quadratic = fit.mean_z = fit.mean_z2 = fit.middle;
  if (kept.empty()) return fit;
  scale(fit, points, kept, width);
  const Rows rows = make_rows(fit, points, value, kept);
  describe_values(fit, rows);
  if (kept.size() < kFewestTrials) return fit;
  Solution best;
  for (const double strength : {1e-3, 1e-2, 0.1, 1.0}) {
    Solution solution = ridge(rows, strength);
    if (solution.leave_one_out < best.leave_one_out) best = std::move(solution);
  }
  if (!(best.leave_one_out < fit.error)) return fit;
  fit.error = best.leave_one_out;
  fit.constant = best.coefficient[0];
  for (std::size_t k = 0; k < rows.variable.size(); ++k) {
    fit.linear[rows.variable[k]] = best.coefficient[1 + 2 * k];
    fit.quadratic[rows.variable[k]] = best.coefficient[2 + 2 * k];
  }
  return fit;
}

double SlopeMeasure::at(BedSlopes s) const {
  const double value = base + s.along * (along + along2 * s.along) + s.across * (across + across2 * s.across);
  return std::clamp(value, lowest, highest);
}

SlopeMeasure on_soil(const MeasureFit& fit, const std::vector<std::vector<double>>& points) {
  const std::size_t a = campaign::contract().variable_index("slope_along"),
                    b = campaign::contract().variable_index("slope_across");
  SlopeMeasure measure;
  for (std::vector<double> point : points) {
    point[a] = 0;
    point[b] = 0;
    measure.base += fit.value(point) / double(points.size());
  }
  // l (x - m) / w + q (x - m)^2 / w^2 as a polynomial in x, whose constant is in `base` already.
  const auto expand = [&fit](std::size_t v, double& first, double& second) {
    if (!(fit.half_width[v] > 0)) return;
    const double w = fit.half_width[v];
    first = fit.linear[v] / w - 2 * fit.quadratic[v] * fit.middle[v] / (w * w);
    second = fit.quadratic[v] / (w * w);
  };
  expand(a, measure.along, measure.along2);
  expand(b, measure.across, measure.across2);
  measure.lowest = fit.lowest;
  measure.highest = fit.highest;
  return measure;
}

namespace {

constexpr std::size_t kTerms = 4;  // constant, rut, slip, speed
constexpr double kMaxSlip = 0.95;

using Row = std::array<double, kTerms>;
using Square = std::array<std::array<double, kTerms + 1>, kTerms>;

Row row_of(const ResistanceTrial& t) { return {1, t.rut, t.slip, t.speed}; }

/// Gauss-Jordan with pivots on the normal equations, a little ridge added so that terms that never vary get no weight.
Row solve(Square a) {
  for (std::size_t k = 0; k < kTerms; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < kTerms; ++i)
      if (std::abs(a[i][k]) > std::abs(a[pivot][k])) pivot = i;
    std::swap(a[k], a[pivot]);
    for (std::size_t i = 0; i < kTerms; ++i) {
      if (i == k) continue;
      const double factor = a[i][k] / a[k][k];
      for (std::size_t j = k; j <= kTerms; ++j) a[i][j] -= factor * a[k][j];
    }
  }
  Row x{};
  for (std::size_t k = 0; k < kTerms; ++k) x[k] = a[k][kTerms] / a[k][k];
  return x;
}

Row least_squares(std::span<const ResistanceTrial> trials) {
  Square a{};
  for (const ResistanceTrial& t : trials) {
    const Row row = row_of(t);
    for (std::size_t i = 0; i < kTerms; ++i) {
      for (std::size_t j = 0; j < kTerms; ++j) a[i][j] += row[i] * row[j];
      a[i][kTerms] += row[i] * t.resistance;
    }
  }
  for (std::size_t i = 1; i < kTerms; ++i) a[i][i] += 1e-9 * double(trials.size());
  return solve(a);
}

}  // namespace

double ResistanceFit::at(double rut, double slip, double tread_speed) const {
  const double value = constant + per_rut * rut + per_slip * slip + per_speed * std::min(tread_speed, fastest);
  return std::clamp(value, lowest, highest);
}

ResistanceFit fit_resistance(std::span<const ResistanceTrial> trials) {
  ResistanceFit fit;
  fit.trials = trials.size();
  if (trials.empty()) return fit;
  const auto of = [&](double ResistanceTrial::*member, auto pick) {
    double value = trials.front().*member;
    for (const ResistanceTrial& t : trials) value = pick(value, t.*member);
    return value;
  };
  const auto smaller = [](double a, double b) { return std::min(a, b); };
  const auto larger = [](double a, double b) { return std::max(a, b); };
  fit.lowest = of(&ResistanceTrial::resistance, smaller);
  fit.highest = of(&ResistanceTrial::resistance, larger);
  fit.fastest = of(&ResistanceTrial::speed, larger);
  double mean = 0;
  for (const ResistanceTrial& t : trials) mean += t.resistance / double(trials.size());
  fit.constant = mean;
  if (trials.size() >= kFewestTrials) {
    const Row x = least_squares(trials);
    fit.constant = x[0];
    fit.per_rut = x[1];
    fit.per_slip = x[2];
    fit.per_speed = x[3];
  }
  double residual = 0, deviation = 0;
  for (const ResistanceTrial& t : trials) {
    residual += std::pow(t.resistance - fit.at(t.rut, t.slip, t.speed), 2) / double(trials.size());
    deviation += std::pow(t.resistance - mean, 2) / double(trials.size());
  }
  fit.error = std::sqrt(residual);
  fit.spread = std::sqrt(deviation);
  return fit;
}

double SpeedModel::rut(double sinks, double load) const {
  return std::max(0.0, sinks - (tyre_stiffness > 0 ? load / tyre_stiffness : 0));
}

SoilSpeed::SoilSpeed(const SpeedModel& model, const std::vector<std::vector<double>>& points, double max_speed)
    : model_(model),
      slip_(on_soil(model.slip, points)),
      sinkage_(on_soil(model.sinkage, points)),
      max_speed_(max_speed) {
  const std::size_t payload = campaign::contract().variable_index("payload");
  for (const std::vector<double>& point : points)
    payload_ += (std::isnan(point[payload]) ? model.slip.middle[payload] : point[payload]) / double(points.size());
}

double SoilSpeed::at(BedSlopes slopes) const {
  const double along = std::tan(to_radians(slopes.along)), across = std::tan(to_radians(slopes.across));
  const double load = (model_.mass + payload_) * model_.gravity / std::sqrt(1 + along * along + across * across);
  const double slip = std::clamp(slip_.at(slopes), 0.0, kMaxSlip), rut = model_.rut(sinkage_.at(slopes), load);
  const double sampled = (1 - slip) * model_.resistance.fastest;
  const auto thrown = [&](double tread_speed) {
    const double speed = (1 - slip) * tread_speed;
    return std::max(0.0, speed * speed - sampled * sampled) * model_.rut_width * rut * kThrownDensity;
  };
  const ResistanceFit& resistance = model_.resistance;
  const double least = std::min(resistance.at(rut, slip, 0), resistance.at(rut, slip, resistance.fastest));
  const double tread_speed = model_.drive.balance(
      [&](double v) { return load * (std::max(0.0, along) + resistance.at(rut, slip, v)) + thrown(v); },
      [&](double v) { return load * (std::max(0.0, along) + least) + thrown(v); });
  return std::clamp((1 - slip) * tread_speed, kMinSpeed, std::max(kMinSpeed, max_speed_));
}

double p_go_of(std::span<const double> outcome) {
  const auto& outcomes = campaign::contract().outcomes;
  double sum = 0;
  for (std::size_t o = 0; o < outcome.size(); ++o)
    if (campaign::passes(outcomes[o].verdict)) sum += outcome[o];
  return sum;
}

namespace {

using Probabilities = std::function<void(std::span<const double> points, std::span<double> result)>;

/// The point without its obstacles: what the soil's model was trained on.
std::vector<double> ground_of(std::span<const double> point) {
  std::vector<double> ground(point.begin(), point.end());
  for (std::size_t v = 0; v < ground.size(); ++v)
    if (campaign::is_task_variable(campaign::contract().variables[v])) ground[v] = 0;
  return ground;
}

/// Takes over the crossing's answer where it is the lower one.
void take_lower(std::span<double> result, std::span<const double> crossing) {
  const double p = p_go_of(crossing);
  if (!(p < p_go_of(result))) return;
  const auto& outcomes = campaign::contract().outcomes;
  for (std::size_t o = 0; o < outcomes.size(); ++o) result[o] = campaign::passes(outcomes[o].verdict) ? crossing[o] : 0;
  result[campaign::contract().outcome_index(campaign::Verdict::no_go, campaign::Reason::obstacle)] = 1 - p;
}

Probabilities with_crossing(const Probabilities& soil, const Probabilities& crossing, double least_bed) {
  return [soil, crossing, least_bed](std::span<const double> points, std::span<double> result) {
    const std::size_t width = campaign::contract().variables.size(), outcomes = campaign::contract().outcomes.size();
    const std::size_t bed = campaign::contract().variable_index("bed_depth");
    std::vector<double> ground, ditches;
    std::vector<std::size_t> with_ditch;
    for (std::size_t i = 0; i * width < points.size(); ++i) {
      const auto point = points.subspan(i * width, width);
      const std::vector<double> alone = ground_of(point);
      ground.insert(ground.end(), alone.begin(), alone.end());
      if (!campaign::has_task_values(point)) continue;
      with_ditch.push_back(i);
      ditches.insert(ditches.end(), point.begin(), point.end());
      double& depth = ditches[ditches.size() - width + bed];
      if (depth < least_bed) depth = least_bed;
    }
    soil(ground, result);
    if (with_ditch.empty()) return;
    std::vector<double> answer(with_ditch.size() * outcomes);
    crossing(ditches, answer);
    for (std::size_t k = 0; k < with_ditch.size(); ++k)
      take_lower(result.subspan(with_ditch[k] * outcomes, outcomes),
                 std::span<const double>(answer).subspan(k * outcomes, outcomes));
  };
}

/// What both have sampled; a task's variables are the crossing's, a shallower bed counts as the crossing's.
std::vector<Range> common_box(const OutcomeModel& model, const OutcomeModel& crossing) {
  std::vector<Range> box = crossing.sampled;
  for (std::size_t v = 0; v < box.size(); ++v) {
    const campaign::Variable& variable = campaign::contract().variables[v];
    if (campaign::is_task_variable(variable)) continue;
    box[v].maximum = std::min(box[v].maximum, model.sampled[v].maximum);
    box[v].minimum =
        variable.name == "bed_depth" ? model.sampled[v].minimum : std::max(box[v].minimum, model.sampled[v].minimum);
  }
  return box;
}

}  // namespace

void add_crossing_model(OutcomeModel& model, const OutcomeModel& crossing) {
  const double least_bed = crossing.sampled[campaign::contract().variable_index("bed_depth")].minimum;
  model.crossing_sampled = common_box(model, crossing);
  model.crossing_hash = crossing.hash;
  model.probabilities = with_crossing(model.probabilities, crossing.probabilities, least_bed);
  for (Probabilities& member : model.members) member = with_crossing(member, crossing.probabilities, least_bed);
  if (!model.novelty || !crossing.novelty) return;
  model.novelty = [soil = model.novelty, ditch = crossing.novelty](std::span<const double> point) {
    const double ground = soil(ground_of(point));
    return campaign::has_task_values(point) ? std::max(ground, ditch(point)) : ground;
  };
}

void KeptAnswers::fill(std::span<const std::span<const double>> asked, std::span<double> answer,
                       const std::function<void(std::span<double>)>& compute) {
  constexpr std::size_t kMostKept = std::size_t(32) << 20;  // numbers
  std::string key;
  for (const std::span<const double> part : asked) {
    key.append(reinterpret_cast<const char*>(part.data()), part.size_bytes());
    key.push_back('|');
  }
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = answers_.find(key); found != answers_.end()) {
      std::copy(found->second.begin(), found->second.end(), answer.begin());
      return;
    }
  }
  compute(answer);
  const std::lock_guard lock(mutex_);
  if (size_ + answer.size() > kMostKept) return;
  if (answers_.try_emplace(std::move(key), answer.begin(), answer.end()).second) size_ += answer.size();
}

}  // namespace gonogo::map
