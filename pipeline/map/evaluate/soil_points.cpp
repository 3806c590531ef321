#include "pipeline/map/evaluate/soil_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/format.h"
#include "base/parallel/host_loop.h"
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

Prospect SoilPoints::nothing_known() const {
  return {std::vector<double>(campaign::contract().outcomes.size(), 0.0), 1, soft_share_};
}

bool SoilPoints::is_asked(double slope_along, double slope_across) const {
  return inside_.count + bounded_.count > 0 &&
         contains(box_[campaign::contract().variable_index("slope_along")], slope_along) &&
         contains(box_[campaign::contract().variable_index("slope_across")], slope_across);
}

namespace {

/// Answers of a model that is asked about every pair of slopes by itself, in the order of SlopeAnswers.
void ask_each(const std::function<void(std::span<const double>, std::span<double>)>& model,
              std::span<const double> points, std::span<const double> along, std::span<const double> across,
              std::span<double> result) {
  const std::size_t variables = campaign::contract().variables.size(), pairs = along.size() * across.size();
  const std::size_t v_along = campaign::contract().variable_index("slope_along"),
                    v_across = campaign::contract().variable_index("slope_across");
  std::vector<double> asked;
  asked.reserve(points.size() * pairs);
  for (std::size_t i = 0; i < points.size(); i += variables)
    for (std::size_t k = 0; k < pairs; ++k) {
      asked.insert(asked.end(), points.begin() + std::ptrdiff_t(i), points.begin() + std::ptrdiff_t(i + variables));
      asked[asked.size() - variables + v_along] = along[k / across.size()];
      asked[asked.size() - variables + v_across] = across[k % across.size()];
    }
  model(asked, result);
}

/// Whether a point has a value of a type of trial, such as the width of a ditch, for which a model on slopes may not be
/// asked. The numbers of a family's vehicle are none.
bool has_task_value(const std::vector<double>& point) {
  const std::vector<campaign::Variable>& variables = campaign::contract().variables;
  for (std::size_t v = 0; v < point.size(); ++v)
    if (variables[v].prior == "task" && point[v] != 0) return true;
  return false;
}

constexpr std::size_t kPointsAtOnce = 32;  // whose answers at all slopes are kept

}  // namespace

/// Sums over the points of one alternative, or over all.
struct SoilPoints::SlopeSums {
  struct Sums {
    std::size_t points = 0, sampled = 0, soft = 0;  // the same at all slopes
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
  std::vector<double> sampled, bounded;  // [outcome] sums of what the points answer
  std::vector<Sums> sums;                // of all points, then of each alternative if there are several

  SlopeSums(std::size_t outcomes, std::size_t alternatives)
      : sampled(outcomes, 0.0), bounded(outcomes, 0.0), sums(1 + (alternatives > 1 ? alternatives : 0)) {}

  /// `most`: P(go) of the point, or the most that it may be.
  void add(int alternative, bool is_sampled, bool is_soft, double most) {
    for (std::size_t k = 0; k < sums.size(); ++k) {
      if (k > 0 && k != 1 + std::size_t(alternative)) continue;
      ++sums[k].points;
      sums[k].sampled += std::size_t(is_sampled);
      sums[k].soft += std::size_t(is_soft);
      (is_sampled ? sums[k].p_go : is_soft ? sums[k].soft_most : sums[k].outside_most) += most;
    }
  }
};

/// Where what every point answers at a pair of slopes is kept.
class SoilPoints::EachAt {
 public:
  EachAt(std::vector<Each>* each, EachOf of, std::size_t along, std::size_t across)
      : each_(each), stride_(of.stride), across_(across) {
    GONOGO_ASSERT(of.stride == 1 || !of.members);
    if (each) each->assign(kept(along) * kept(across), {});
  }
  /// Null where nothing is kept.
  Each* operator()(std::size_t pair) const {
    const std::size_t a = pair / across_, b = pair % across_;
    return each_ && a % stride_ == 0 && b % stride_ == 0 ? &(*each_)[a / stride_ * kept(across_) + b / stride_]
                                                         : nullptr;
  }

 private:
  std::size_t kept(std::size_t slopes) const { return (slopes + stride_ - 1) / stride_; }

  std::vector<Each>* each_;
  std::size_t stride_, across_;
};

std::vector<Prospect> SoilPoints::on_slopes(const OutcomeModel& model, std::span<const double> along,
                                            std::span<const double> across, std::vector<Each>* each, EachOf of) const {
  const std::size_t pairs = along.size() * across.size(), outcomes = campaign::contract().outcomes.size();
  std::vector<Prospect> prospects(pairs, nothing_known());
  const EachAt each_at(each, of, along.size(), across.size());
  if (inside_.count + bounded_.count == 0) return prospects;
  const bool has_task = has_task_value(all_.front());
  const auto ask = [&](std::span<const double> points, std::span<double> result) {
    if (model.on_slopes && !has_task)
      model.on_slopes(points, along, across, result);
    else
      ask_each(model.probabilities, points, along, across, result);
  };
  enum Kind : char { unanswered, sampled, bounded };
  std::vector<Kind> kind(all_.size(), unanswered);
  std::vector<const double*> value(all_.size(), nullptr);
  const std::size_t variables = campaign::contract().variables.size();
  for (const Asked* asked : {&inside_, &bounded_})
    for (std::size_t k = 0; k < asked->count; ++k) {
      kind[asked->origin[k]] = asked == &inside_ ? sampled : bounded;
      value[asked->origin[k]] = asked->value.data() + k * variables;
    }
  std::vector<SlopeSums> sums(pairs, SlopeSums(outcomes, alternatives_));
  for (std::size_t first = 0; first < all_.size(); first += kPointsAtOnce) {
    const std::size_t last = std::min(all_.size(), first + kPointsAtOnce);
    std::vector<double> points;
    for (std::size_t i = first; i < last; ++i)
      if (value[i]) points.insert(points.end(), value[i], value[i] + variables);
    std::vector<double> answers(points.size() / variables * pairs * outcomes);
    if (!points.empty()) ask(points, answers);
    for_each_on_host(pairs, 64, [&](std::size_t pair) {
      Each* own = each_at(pair);
      std::size_t k = 0;
      for (std::size_t i = first; i < last; ++i) {
        double most = 1;
        if (kind[i] != unanswered) {
          const auto answer = std::span<const double>(answers).subspan((k++ * pairs + pair) * outcomes, outcomes);
          most = p_go_of(answer);
          std::vector<double>& mean = kind[i] == sampled ? sums[pair].sampled : sums[pair].bounded;
          const double count = double(kind[i] == sampled ? inside_.count : bounded_.count);
          for (std::size_t o = 0; o < outcomes; ++o) mean[o] += answer[o] / count;
          if (own) (kind[i] == sampled ? own->sampled : own->most).push_back(most);
        }
        sums[pair].add(alternative_[i], kind[i] == sampled, soft_.is_soft[i] != 0, most);
      }
    });
  }
  if (each && of.members) add_members(model, along, across, *each);
  for (std::size_t pair = 0; pair < pairs; ++pair) {
    if (!is_asked(along[pair / across.size()], across[pair % across.size()])) {
      if (Each* own = each_at(pair)) *own = {};
      continue;
    }
    prospects[pair] = prospect_of(sums[pair]);
  }
  return prospects;
}

Prospect SoilPoints::prospect_of(const SlopeSums& sums) const {
  Prospect prospect = nothing_known();
  if (inside_.count > 0) prospect.outcome = sums.sampled;
  if (bounded_.count > 0) prospect.bounding = sums.bounded;
  const Estimate whole = sums.sums.front().estimate();
  prospect.outside_share = whole.outside_share;
  prospect.soft_most = whole.soft_most;
  prospect.outside_most = whole.outside_most;
  for (std::size_t k = 1; k < sums.sums.size(); ++k)
    if (sums.sums[k].points > 0) prospect.alternative.push_back(sums.sums[k].estimate());
  return prospect;
}

void SoilPoints::add_members(const OutcomeModel& model, std::span<const double> along, std::span<const double> across,
                             std::vector<Each>& each) const {
  const std::size_t pairs = each.size(), outcomes = campaign::contract().outcomes.size();
  const std::size_t variables = campaign::contract().variables.size();
  for (const Probabilities& member : model.members)
    for (const Asked* asked : {&inside_, &bounded_})
      for (std::size_t k = 0; k < asked->count; ++k) {
        std::vector<double> answers(pairs * outcomes);
        ask_each(member, std::span(asked->value).subspan(k * variables, variables), along, across, answers);
        for (std::size_t pair = 0; pair < pairs; ++pair)
          (asked == &inside_ ? each[pair].sampled : each[pair].most)
              .push_back(p_go_of(std::span<const double>(answers).subspan(pair * outcomes, outcomes)));
      }
}

Prospect SoilPoints::at(const OutcomeModel& model, double slope_along, double slope_across) const {
  return on_slopes(model, {&slope_along, 1}, {&slope_across, 1}).front();
}

std::vector<double> SoilPoints::novelty_uphill(const OutcomeModel& model, std::span<const double> slopes) const {
  const std::size_t stride = all_.size() > 32 ? std::max<std::size_t>(1, all_.size() / 16) : 1;
  const std::size_t count = (all_.size() + stride - 1) / stride;
  std::vector<std::vector<double>> of_point(count, std::vector<double>(slopes.size()));
  for_each_on_host(count, 1, [&](std::size_t k) {
    std::vector<double> point = all_[k * stride];
    point[campaign::contract().variable_index("slope_across")] = 0;
    if (model.novelty_uphill && !campaign::has_task_values(point))
      return model.novelty_uphill(point, slopes, of_point[k]);
    for (std::size_t i = 0; i < slopes.size(); ++i) {
      point[campaign::contract().variable_index("slope_along")] = slopes[i];
      of_point[k][i] = model.novelty(point);
    }
  });
  std::vector<double> mean(slopes.size(), 0.0);
  for (const std::vector<double>& novelty : of_point)
    for (std::size_t i = 0; i < slopes.size(); ++i) mean[i] += novelty[i];
  for (double& value : mean) value /= double(count);
  return mean;
}

}  // namespace gonogo::map
