#include "pipeline/map/evaluate/soil_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/format.h"
#include "base/units.h"
#include "terrain/soil/soil.h"

namespace gonogo::map {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Number in psi, as cone indices are quoted.
std::string in_psi(double pascal) { return line("%.0f psi", pascal / kPsi); }

double estimated_index(const std::vector<double>& point) {
  const double cohesion = point[campaign::contract().variable_index("cohesion")];
  const double angle = point[campaign::contract().variable_index("friction_angle")];
  return terrain::cone_index(cohesion * 1e3, angle);  // NaN if one of them is not known
}

std::string texture_text(const Region& region, const Soil& soil) {
  const std::string& texture = soil.texture.empty() ? region.texture : soil.texture;
  if (!soil.given) return "where it is loam or finer";
  return texture.empty() ? line("a friction angle below %g degrees", kMinAngleOfSand) : texture;
}

/// Cone indices of the soft points of a soil.
struct Weakness {
  double least = std::numeric_limits<double>::infinity(), most = 0;  // index of soft points [Pa]
  std::size_t weak = 0, unclear = 0;                                 // points

  void add(double index) {
    if (std::isnan(index)) {
      ++unclear;
      return;
    }
    ++weak;
    least = std::min(least, index);
    most = std::max(most, index);
  }
};

std::vector<std::string> sentences(const Weakness& found, std::size_t points, const std::string& texture,
                                   const std::optional<ConeIndexNeed>& need) {
  const auto of_all = [&](std::size_t count) {
    return count == points ? std::string() : line(", %.0f %% of its points", 100.0 * double(count) / double(points));
  };
  if (!need && found.weak + found.unclear > 0)
    return {"fine-grained (" + texture + "), and no vehicle is given to compare its cone index with" +
            of_all(found.weak + found.unclear)};
  std::vector<std::string> because;
  if (found.weak > 0) {
    const std::string least = in_psi(found.least), most = in_psi(found.most);
    because.push_back("fine-grained (" + texture + ") with a cone index of " +
                      (least == most ? least : least + " to " + most) + " where " + need->vehicle + " needs " +
                      in_psi(need->fifty_passes) + " (VCI50)" + of_all(found.weak));
  }
  if (found.unclear > 0)
    because.push_back("fine-grained (" + texture + ") with a unknown cohesion or friction angle" +
                      of_all(found.unclear));
  return because;
}

}  // namespace

std::optional<bool> is_fine_grained(const Region& region, const Soil& soil) {
  std::optional<bool> fine;
  for (const SoilSample& sample : soil.samples)
    if (!sample.texture.empty()) fine = fine.value_or(false) || terrain::is_fine_grained(sample.texture);
  if (fine) return fine;
  const std::string& texture = soil.texture.empty() ? region.texture : soil.texture;
  if (texture.empty()) return std::nullopt;
  return terrain::is_fine_grained(texture);
}

SoftPoints soft_points(const Region& region, const Soil& soil, const std::vector<std::vector<double>>& points,
                       const std::optional<ConeIndexNeed>& need) {
  const std::size_t angle = campaign::contract().variable_index("friction_angle");
  const std::size_t draws = points.size() / std::max<std::size_t>(1, soil.samples.size());
  const std::optional<bool> fine = is_fine_grained(region, soil);
  SoftPoints soft{std::vector<char>(points.size(), 0), {}};
  Weakness found;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SoilSample* sample = soil.samples.empty() ? nullptr : &soil.samples[i / draws];
    const bool known = sample && !sample->texture.empty();
    if (known ? !terrain::is_fine_grained(sample->texture) : !fine.value_or(points[i][angle] < kMinAngleOfSand))
      continue;
    const std::optional<double> measured = sample ? sample->cone_index : std::nullopt;
    const double index = measured ? *measured : estimated_index(points[i]);
    if (need && index >= need->fifty_passes) continue;
    soft.is_soft[i] = 1;
    found.add(need ? index : kUnknown);
  }
  soft.because = sentences(found, points.size(), texture_text(region, soil), need);
  return soft;
}

namespace {

constexpr const char* kStrengths[] = {"friction_angle", "cohesion"};
constexpr Range kNothing = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};

Range widened(Range found, double value) { return {std::min(found.minimum, value), std::max(found.maximum, value)}; }

/// "cohesion 9 <unit> <what>", or "cohesion 6.1 to 9 <unit> <what>, 20 % of its points".
std::string describe(const campaign::Variable& variable, Range found, double share, const std::string& what) {
  const std::string tail = " " + variable.unit + " " + what;
  if (found.minimum == found.maximum) return variable.name + line(" %g", found.minimum) + tail;
  return variable.name + line(" %.4g to %.4g", found.minimum, found.maximum) + tail +
         line(", %.0f %% of its points", 100 * share);
}

}  // namespace

bool contains(Range sampled, double value) {
  const double slack = 1e-9 * std::max(std::abs(sampled.minimum), std::abs(sampled.maximum));
  return value >= sampled.minimum - slack && value <= sampled.maximum + slack;
}

SoftPoints measured_soft(std::size_t points, const ConeIndexNeed& need) {
  return {std::vector<char>(points, 1),
          {"its measured cone index lies between " + in_psi(need.one_pass) + " (VCI1) and " +
           in_psi(need.fifty_passes) + " (VCI50) of " + need.vehicle}};
}

std::vector<int> point_alternatives(const Soil& soil, std::size_t points) {
  std::set<int> different;
  for (const SoilSample& sample : soil.samples) different.insert(sample.alternative);
  if (different.size() < 2) return {};
  std::vector<int> alternative;
  for (std::size_t i = 0; i < points; ++i)
    alternative.push_back(soil.samples[i * soil.samples.size() / points].alternative);
  return alternative;
}

SoilPoints::SoilPoints(const OutcomeModel& model, std::vector<std::vector<double>> points, SoftPoints soft,
                       std::vector<int> alternative)
    : all_(std::move(points)), alternative_(std::move(alternative)), soft_(std::move(soft)) {
  box_ = model.box_of(all_.front());  // all points of a soil have a ditch, or none has
  limit_strength();
  soft_.is_soft.resize(all_.size(), 0);
  alternative_.resize(all_.size(), 0);
  alternatives_ = 1 + std::size_t(*std::max_element(alternative_.begin(), alternative_.end()));
  divide();
  find_outside();
}

void SoilPoints::Asked::add(const std::vector<double>& point, std::size_t index) {
  value.insert(value.end(), point.begin(), point.end());
  origin.push_back(index);
  ++count;
}

bool SoilPoints::is_outside(const std::vector<double>& point) const {
  for (std::size_t v = 0; v < point.size(); ++v)
    if (!std::isnan(point[v]) && !contains(box_[v], point[v])) return true;
  return false;
}

std::vector<double> SoilPoints::raised(std::vector<double> point) const {
  for (const char* name : kStrengths) {
    const std::size_t v = campaign::contract().variable_index(name);
    point[v] = std::isnan(point[v]) ? box_[v].maximum : std::max(point[v], box_[v].minimum);
  }
  return point;
}

void SoilPoints::divide() {
  std::size_t soft_count = 0;
  for (std::size_t i = 0; i < all_.size(); ++i) {
    soft_count += soft_.is_soft[i] != 0;
    if (!soft_.is_soft[i] && !is_outside(all_[i]))
      inside_.add(all_[i], i);
    else if (const auto stronger = raised(all_[i]); !is_outside(stronger))
      bounded_.add(stronger, i);
  }
  soft_share_ = double(soft_count) / double(all_.size());
}

void SoilPoints::limit_strength() {
  for (const char* name : kStrengths) {
    const std::size_t v = campaign::contract().variable_index(name);
    const Range sampled = box_[v];
    Range found = kNothing;
    std::size_t count = 0;
    for (std::vector<double>& point : all_) {
      if (!(point[v] > sampled.maximum) || contains(sampled, point[v])) continue;
      found = widened(found, point[v]);
      point[v] = sampled.maximum;
      ++count;
    }
    if (count == 0) continue;
    const campaign::Variable& variable = campaign::contract().variables[v];
    stronger_because_.push_back(
        describe(variable, found, double(count) / double(all_.size()),
                 line("counts as %g %s, the most that was sampled", sampled.maximum, variable.unit.c_str())));
  }
}

void SoilPoints::find_outside() {
  const auto& variables = campaign::contract().variables;
  outside_share_.assign(variables.size(), 0);
  for (std::size_t v = 0; v < variables.size(); ++v) {
    const Range sampled = box_[v];
    Range found = kNothing;
    for (const std::vector<double>& point : all_) {
      if (std::isnan(point[v]) || contains(sampled, point[v])) continue;
      outside_share_[v] += 1 / double(all_.size());
      found = widened(found, point[v]);
    }
    if (outside_share_[v] > 0)
      outside_because_.push_back(
          describe(variables[v], found, outside_share_[v],
                   line("is outside %g to %g %s", sampled.minimum, sampled.maximum, variables[v].unit.c_str())));
  }
}

campaign::Reason SoilPoints::reason_outside() const { return reason_of_unknown(Prospect{{}, 1, soft_share_}); }

std::vector<double> SoilPoints::Asked::answers(const Probabilities& model, double slope_along,
                                               double slope_across) const {
  const std::size_t variables = campaign::contract().variables.size();
  const std::size_t along = campaign::contract().variable_index("slope_along");
  const std::size_t across = campaign::contract().variable_index("slope_across");
  std::vector<double> points = value, result(count * campaign::contract().outcomes.size());
  for (std::size_t i = 0; i < count; ++i) {
    points[i * variables + along] = slope_along;
    points[i * variables + across] = slope_across;
  }
  if (count > 0) model(points, result);
  return result;
}

Prospect SoilPoints::nothing_known() const {
  return {std::vector<double>(campaign::contract().outcomes.size(), 0.0), 1, soft_share_};
}

bool SoilPoints::is_asked(double slope_along, double slope_across) const {
  return inside_.count + bounded_.count > 0 &&
         contains(box_[campaign::contract().variable_index("slope_along")], slope_along) &&
         contains(box_[campaign::contract().variable_index("slope_across")], slope_across);
}

namespace {

/// Mean outcomes of rows of answers; empty without any.
std::vector<double> mean_of(const std::vector<double>& answers, std::size_t rows) {
  const std::size_t outcomes = campaign::contract().outcomes.size();
  if (rows == 0) return {};
  std::vector<double> mean(outcomes, 0.0);
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t o = 0; o < outcomes; ++o) mean[o] += answers[i * outcomes + o] / double(rows);
  return mean;
}

void append_p_go(const std::vector<double>& answers, std::vector<double>& p_go) {
  const auto& outcomes = campaign::contract().outcomes;
  for (std::size_t i = 0; i * outcomes.size() < answers.size(); ++i) {
    double sum = 0;
    for (std::size_t o = 0; o < outcomes.size(); ++o)
      if (outcomes[o].verdict != campaign::Verdict::no_go) sum += answers[i * outcomes.size() + o];
    p_go.push_back(sum);
  }
}

/// Sums over the points of one alternative, or over all.
struct PointSums {
  std::size_t points = 0, sampled = 0, soft = 0;
  double p_go = 0, soft_most = 0, outside_most = 0;

  Estimate estimate() const {
    const std::size_t outside = points - sampled - soft;
    return {.p_go = sampled > 0 ? p_go / double(sampled) : 0,
            .outside_share = 1 - double(sampled) / double(points),
            .soft_share = double(soft) / double(points),
            .soft_most = soft > 0 ? soft_most / double(soft) : 1,
            .outside_most = outside > 0 ? outside_most / double(outside) : 1};
  }
};

}  // namespace

void SoilPoints::estimate(const std::vector<double>& sampled, const std::vector<double>& bounded,
                          Prospect& prospect) const {
  std::vector<double> p_sampled, p_bounded, most(all_.size(), 1.0);
  append_p_go(sampled, p_sampled);
  append_p_go(bounded, p_bounded);
  std::vector<char> known(all_.size(), 0);
  for (std::size_t k = 0; k < inside_.count; ++k) known[inside_.origin[k]] = 1, most[inside_.origin[k]] = p_sampled[k];
  for (std::size_t k = 0; k < bounded_.count; ++k) most[bounded_.origin[k]] = p_bounded[k];
  PointSums all;
  std::vector<PointSums> part(alternatives_);
  for (std::size_t i = 0; i < all_.size(); ++i)
    for (PointSums* sums : {&all, &part[std::size_t(alternative_[i])]}) {
      ++sums->points;
      sums->sampled += std::size_t(known[i]);
      sums->soft += std::size_t(soft_.is_soft[i]);
      (known[i] ? sums->p_go : soft_.is_soft[i] ? sums->soft_most : sums->outside_most) += most[i];
    }
  const Estimate whole = all.estimate();
  prospect.outside_share = whole.outside_share;
  prospect.soft_most = whole.soft_most;
  prospect.outside_most = whole.outside_most;
  if (!has_alternatives()) return;
  for (const PointSums& sums : part)
    if (sums.points > 0) prospect.alternative.push_back(sums.estimate());
}

Prospect SoilPoints::at(const OutcomeModel& model, double slope_along, double slope_across, Each* each) const {
  Prospect prospect = nothing_known();
  if (each) *each = {};
  if (!is_asked(slope_along, slope_across)) return prospect;
  const std::vector<double> sampled = inside_.answers(model.probabilities, slope_along, slope_across),
                            bounded = bounded_.answers(model.probabilities, slope_along, slope_across);
  if (inside_.count > 0) prospect.outcome = mean_of(sampled, inside_.count);
  prospect.bounding = mean_of(bounded, bounded_.count);
  estimate(sampled, bounded, prospect);
  if (!each) return prospect;
  append_p_go(sampled, each->sampled);
  append_p_go(bounded, each->most);
  for (const Probabilities& member : model.members) {
    append_p_go(inside_.answers(member, slope_along, slope_across), each->sampled);
    append_p_go(bounded_.answers(member, slope_along, slope_across), each->most);
  }
  return prospect;
}

double SoilPoints::novelty(const OutcomeModel& model, double slope_along, double slope_across) const {
  double sum = 0;
  const std::size_t stride = std::max<std::size_t>(1, all_.size() / 16);
  std::size_t count = 0;
  for (std::size_t i = 0; i<all_.size(); i += all_.size()> 32 ? stride : 1) {
    std::vector<double> point = all_[i];
    ++count;
    point[campaign::contract().variable_index("slope_along")] = slope_along;
    point[campaign::contract().variable_index("slope_across")] = slope_across;
    sum += model.novelty(point);
  }
  return sum / double(count);
}

}  // namespace gonogo::map
