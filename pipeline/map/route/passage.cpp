#include "pipeline/map/route/passage.h"

#include <omp.h>
#include <algorithm>
#include <limits>
#include <unordered_map>
#include <utility>

#include "base/error.h"
#include "base/parallel/host_loop.h"
#include "base/units.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/map/evaluate/soil_response.h"

namespace gonogo::map {

namespace {

constexpr std::uint16_t kPasses = 0xffff;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Streams of random numbers of a draw.
enum Stream : std::uint64_t { kMission, kModel, kSoil, kUnknown, kHeights, kField, kBeds, kStreams };

/// How pieces end in one draw: kPasses, or the likeliest no-go outcome [piece].
using Ends = std::vector<std::uint16_t>;

/// All inputs of one piece, rounded like the map's, with the soil's point that holds there.
struct Place {
  std::size_t version;  // counts the points drawn so far
  int along, across;    // [1 / kHeadingSteps deg]
};

/// Payload, tyres and speed stay the same on the whole way; ditches do not.
bool is_of_mission(const campaign::Variable& variable) {
  return variable.source.rfind("soil table", 0) != 0 && !campaign::is_task_variable(variable);
}

/// What all draws share.
struct Course {
  Course(const std::vector<WayPiece>& pieces, const std::vector<WaySoil>& soils, const OutcomeModel& model,
         const PassageDoubt& doubt)
      : pieces(pieces), soils(soils), model(model), doubt(doubt) {
    for (const campaign::Variable& variable : campaign::contract().variables)
      of_mission.push_back(is_of_mission(variable));
    if (doubt.height_error > 0) number_heights();
  }

  const std::vector<WayPiece>& pieces;
  const std::vector<WaySoil>& soils;
  const OutcomeModel& model;
  const PassageDoubt& doubt;
  const std::size_t along = campaign::contract().variable_index("slope_along"),
                    across = campaign::contract().variable_index("slope_across");
  std::vector<char> of_mission;                             // [variable]
  std::vector<std::uint64_t> height;                        // numbers of the heights that err on the way
  std::vector<std::array<std::uint32_t, 9>> height_beside;  // [piece][3 (dy + 1) + dx + 1] position in `height`

 private:
  void number_heights() {
    std::unordered_map<std::uint64_t, std::uint32_t> position;
    for (const WayPiece& piece : pieces) {
      auto beside = height_beside.emplace_back().begin();
      for (const int dy : {-1, 0, 1})
        for (const int dx : {-1, 0, 1}) {
          const std::uint64_t number = height_number(piece.column + dx, piece.row + dy);
          const auto [found, is_new] = position.try_emplace(number, std::uint32_t(height.size()));
          if (is_new) height.push_back(number);
          *beside++ = found->second;
        }
    }
  }
};

class Draw {
 public:
  Draw(const Course& course, std::uint64_t number) : course_(course), first_stream_(number * kStreams) {}

  Ends traverse() {
    draw_mission();
    for (const std::uint64_t number : course_.height)
      heights_.push_back(random_normal(doubt_.seed, first_stream_ + kHeights, number));
    for (const WayPiece& piece : pieces_) enter(piece);
    return ends_of(ask_model(), draw_rest());
  }

 private:
  double unit(Stream stream, std::uint64_t index) const {
    return random_unit(doubt_.seed, first_stream_ + stream, index);
  }
  std::size_t one_of(std::size_t count, Stream stream, std::uint64_t index) const {
    return std::min(count - 1, std::size_t(unit(stream, index) * double(count)));
  }

  /// Anywhere in what was sampled, which is what the model takes an unknown variable for.
  void fill(std::vector<double>& point, std::size_t v, std::uint64_t index) const {
    const Range range = model_.sampled[v];
    if (std::isnan(point[v])) point[v] = range.minimum + unit(kUnknown, index) * (range.maximum - range.minimum);
  }

  void draw_mission() {
    const WaySoil& first = soils_[pieces_.front().soil];
    mission_ = first.points[one_of(first.points.size(), kMission, 0)];
    for (std::size_t v = 0; v < mission_.size(); ++v) fill(mission_, v, v);
    point_.assign(soils_.size(), 0);
    left_at_.assign(soils_.size(), -std::numeric_limits<double>::infinity());
  }

  /// Draws the soil's point anew as often as the length of its correlation asks for.
  void draw_soil(const WayPiece& piece) {
    const double away = piece.begin - left_at_[piece.soil];
    left_at_[piece.soil] = piece.begin;
    const std::size_t here = std::size_t(&piece - pieces_.data());
    if (unit(kSoil, 2 * here) < std::exp(-away / doubt_.soil_length)) return;
    const WaySoil& soil = soils_[piece.soil];
    std::vector<double> point = soil.points[one_of(soil.points.size(), kSoil, 2 * here + 1)];
    for (std::size_t v = 0; v < point.size(); ++v) {
      if (course_.of_mission[v]) point[v] = mission_[v];
      fill(point, v, (points_.size() + 1) * point.size() + v);
    }
    point_[piece.soil] = points_.size();
    points_.push_back(std::move(point));
  }

  void enter(const WayPiece& piece) {
    draw_soil(piece);
    std::array<double, 2> error = {0, 0};
    if (!heights_.empty()) {
      const auto& beside = course_.height_beside[std::size_t(&piece - pieces_.data())];
      const auto height = [&](int dx, int dy) { return heights_[beside[std::size_t(3 * (dy + 1) + dx + 1)]]; };
      error = gradient_noise(height, doubt_.height_error, doubt_.cell_width, doubt_.cell_height);
    }
    const SlopesOnWay slopes = slopes_on_way(piece, error);
    const auto step = [&](double rise, std::size_t variable) {
      const Range range = model_.sampled[variable];
      const double slope = std::clamp(to_degrees(std::atan(rise)), range.minimum, range.maximum);
      return int(std::lround(slope * kHeadingSteps));
    };
    const Place place = {point_[piece.soil], step(slopes.along, course_.along), step(slopes.across, course_.across)};
    const std::uint64_t key = (std::uint64_t(place.version) << 32) | (std::uint64_t(std::uint16_t(place.along)) << 16) |
                              std::uint16_t(place.across);
    const auto [found, is_new] = index_.try_emplace(key, places_.size());
    if (is_new) places_.push_back(place);
    place_of_.push_back(found->second);
  }

  double slope_at(std::size_t variable, int steps) const {
    const Range range = model_.sampled[variable];
    return std::clamp(double(steps) / kHeadingSteps, range.minimum, range.maximum);
  }

  /// The rest's field at all places. Its waves are joined from those of a slope along, a slope across and a point
  /// drawn, of which there are far fewer than of places.
  std::vector<double> draw_rest() const {
    const LikenessField field(model_.sampled, doubt_.likeness, doubt_.seed, first_stream_ + kField);
    std::vector<LikenessField::Waves> drawn;
    for (std::vector<double> point : points_) {
      point[course_.along] = point[course_.across] = kNaN;
      drawn.push_back(field.waves(point));
    }
    std::unordered_map<int, LikenessField::Waves> along, across;
    const auto waves_of = [&](auto& known, std::size_t v, int steps) -> const LikenessField::Waves& {
      const auto [found, is_new] = known.try_emplace(steps);
      if (is_new) {
        std::vector<double> slope_alone(mission_.size(), kNaN);
        slope_alone[v] = slope_at(v, steps);
        found->second = field.waves(slope_alone);
      }
      return found->second;
    };
    std::vector<double> rest;
    for (const Place& place : places_) {
      const auto slopes = LikenessField::joined(waves_of(along, course_.along, place.along),
                                                waves_of(across, course_.across, place.across));
      rest.push_back(field.at(LikenessField::joined(drawn[place.version], slopes)));
    }
    return rest;
  }

  /// Outcome probabilities of all places [place][outcome].
  std::vector<double> ask_model() const {
    std::vector<double> points, answers(places_.size() * campaign::contract().outcomes.size());
    points.reserve(places_.size() * mission_.size());
    for (const Place& place : places_) {
      const std::vector<double>& drawn = points_[place.version];
      double* x = &*points.insert(points.end(), drawn.begin(), drawn.end());
      x[course_.along] = slope_at(course_.along, place.along);
      x[course_.across] = slope_at(course_.across, place.across);
    }
    const std::size_t chosen = one_of(1 + model_.members.size(), kModel, 0);
    (chosen == 0 ? model_.probabilities : model_.members[chosen - 1])(points, answers);
    return answers;
  }

  /// rest: of draw_rest().
  Ends ends_of(const std::vector<double>& answers, const std::vector<double>& rest) const {
    const auto& outcomes = campaign::contract().outcomes;
    Ends ends;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const double* answer = &answers[place_of_[i] * outcomes.size()];
      const auto bed = std::uint64_t(pieces_[i].begin / doubt_.bed_length);
      const double z = std::sqrt(1 - doubt_.bed_share) * rest[place_of_[i]] +
                       std::sqrt(doubt_.bed_share) * random_normal(doubt_.seed, first_stream_ + kBeds, bed);
      double p_go = 0;
      std::size_t worst = 0;
      for (std::size_t o = 0; o < outcomes.size(); ++o)
        if (campaign::passes(outcomes[o].verdict))
          p_go += answer[o];
        else if (campaign::passes(outcomes[worst].verdict) || answer[o] > answer[worst])
          worst = o;
      ends.push_back(p_go < 0.5 * std::erfc(z / std::sqrt(2.0)) ? std::uint16_t(worst) : kPasses);
    }
    return ends;
  }

  const Course& course_;
  const std::vector<WayPiece>& pieces_ = course_.pieces;
  const std::vector<WaySoil>& soils_ = course_.soils;
  const OutcomeModel& model_ = course_.model;
  const PassageDoubt& doubt_ = course_.doubt;
  std::uint64_t first_stream_;
  std::vector<double> mission_;              // [variable]
  std::vector<double> heights_;              // errors beside the way, of variance 1, as Course::height numbers them
  std::vector<std::vector<double>> points_;  // drawn so far [version][variable]
  std::vector<std::size_t> point_;           // [soil] its version
  std::vector<double> left_at_;              // [soil] where the way was last on it [m]
  std::vector<Place> places_;                // different inputs
  std::vector<std::size_t> place_of_;        // [piece]
  std::unordered_map<std::uint64_t, std::size_t> index_;
};

/// Places where a draw stops: stopping pieces that are less than `apart` away from each other are one.
int count_places(const std::vector<WayPiece>& pieces, const Ends& ends, double apart) {
  int count = 0;
  double last = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (ends[i] == kPasses) continue;
    count += pieces[i].begin - last >= apart;
    last = pieces[i].end;
  }
  return count;
}

/// The outermost piece on one side that still belongs to the stretch around the weakest one.
std::size_t edge_of(const std::vector<WayPiece>& pieces, const std::vector<double>& stuck, std::size_t weakest,
                    int step, double apart) {
  std::size_t edge = weakest;
  for (std::size_t i = weakest; i < pieces.size(); i += std::size_t(step)) {  // wraps around below zero
    if (std::abs(pieces[i].begin - pieces[edge].begin) > apart) break;
    if (stuck[i] >= 0.5 * stuck[weakest]) edge = i;
  }
  return edge;
}

WeakestStretch weakest_of(const std::vector<WayPiece>& pieces, const std::vector<double>& stuck,
                          const std::vector<Ends>& ends, double apart) {
  const auto piece = std::size_t(std::max_element(stuck.begin(), stuck.end()) - stuck.begin());
  const std::size_t first = edge_of(pieces, stuck, piece, -1, apart), last = edge_of(pieces, stuck, piece, 1, apart);
  std::vector<int> times(campaign::contract().outcomes.size(), 0);
  int stops = 0;
  for (const Ends& end : ends) {
    bool stopped = false;
    for (std::size_t i = first; i <= last; ++i) {
      if (end[i] == kPasses) continue;
      ++times[end[i]];
      stopped = true;
    }
    stops += stopped;
  }
  return {.begin = pieces[first].begin,
          .end = pieces[last].end,
          .stuck = double(stops) / double(ends.size()),
          .outcome = std::size_t(std::max_element(times.begin(), times.end()) - times.begin()),
          .piece = piece,
          .first = first,
          .last = last};
}

}  // namespace

SlopesOnWay slopes_on_way(const WayPiece& piece, std::array<double, 2> error) {
  const double sine = std::sin(piece.heading * kDegree), cosine = std::cos(piece.heading * kDegree);
  const double east = piece.rise_east + error[0], north = piece.rise_north + error[1];
  return {.along = east * sine + north * cosine, .across = north * sine - east * cosine};
}

PassageForecast forecast_passage(const std::vector<WayPiece>& pieces, const std::vector<WaySoil>& soils,
                                 const OutcomeModel& model, const PassageDoubt& doubt) {
  PassageForecast forecast;
  forecast.stuck.assign(pieces.size(), 0);
  if (pieces.empty()) return forecast;
  const Course course(pieces, soils, model, doubt);
  std::vector<Ends> ends(static_cast<std::size_t>(doubt.draws));
  for_each_on_host(ends.size(), 1, [&](std::size_t d) { ends[d] = Draw(course, d).traverse(); });
  int through = 0, places = 0;
  for (const Ends& end : ends) {
    const int here = count_places(pieces, end, doubt.bed_length);
    through += here == 0;
    places += here;
    for (std::size_t i = 0; i < pieces.size(); ++i) forecast.stuck[i] += (end[i] != kPasses) / double(doubt.draws);
  }
  forecast.chance = double(through) / doubt.draws;
  forecast.error = std::sqrt(forecast.chance * (1 - forecast.chance) / doubt.draws);
  forecast.places = double(places) / doubt.draws;
  std::vector<char> met(soils.size());
  double answered = 1;
  for (const WayPiece& piece : pieces)
    if (!std::exchange(met[piece.soil], char(1))) answered *= 1 - soils[piece.soil].not_sampled;
  forecast.not_sampled = 1 - answered;
  if (places > 0) forecast.weakest = weakest_of(pieces, forecast.stuck, ends, doubt.bed_length);
  return forecast;
}

}  // namespace gonogo::map
