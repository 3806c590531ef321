// From outcome probabilities to the class and reason of a cell.
//
// P(go) is the probability that a valid trial ends in go or slow_go. Let u be the share of the soil's points that was
// never sampled, p the P(go) of the others, and m the most that P(go) of the unsampled points may be: that of the
// weakest sampled strength where they are weaker, else 1. P(go) then lies between p (1 - u) and p (1 - u) + u m. A cell
// gets a class only if the whole interval agrees on it; otherwise it is unknown. So no cell is go because of soil that
// was not simulated, and soil that is weaker than the weakest sampled one is no_go where that is. Points that are too
// soft (pipeline/map/evaluate/soil_points.h) count as not sampled.
//
// A soil that nobody named, or whose moisture nobody named, is one of several alternatives. A cell is no_go if each of
// them is, unknown if only some may be, and go only if each is at least that. So what is not known never makes a cell
// better than unknown where the soil, once known, is no_go.
#pragma once
#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <vector>

#include "base/json/config.h"
#include "base/units.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/map/soils/soil.h"

namespace gonogo::map {

/// The heading that class, P(go) and reason of a map refer to.
enum class HeadingMode { uphill, worst, best, set };

/// The section "map" of a study.
struct MapRules {
  HeadingMode heading_mode = HeadingMode::uphill;
  double heading = 0;                  // [deg clockwise from grid north], for HeadingMode::set
  double correlation_length = 100;     // [m] chances of passing are equal within, independent beyond; for routes
  double go = 0.8;                     // P(go) at or above: go, or slow_go if that is likelier
  double no_go = 0.5;                  // P(go) below: no_go; between the two: slow_go
  double tolerated_outside_share = 0;  // max share not sampled that counts as the sampled part does
  std::string moisture;                // "dry", "moist" or "wet" everywhere; empty: by the raster, or any
  int draws = 16;                      // points drawn from the ranges of a soil
  std::string fidelity = "fidelity of the trials not stated";  // printed under the title of the figure
  double max_speed = std::numeric_limits<double>::infinity();  // of the mission: no faster, wherever [m/s]
  Spreads values;                       // of the mission, such as payload; win over soil and region
  std::filesystem::path cone_index_of;  // vehicle file; its VCI is the limit of fine-grained soil
};

/// Limits of the section's max_speed_km_h.
inline constexpr Range kMaxSpeedRange = {1, 300};

/// Reads the section; without one the defaults hold. Throws InputError.
MapRules read_map_rules(const std::optional<Config>& section);

/// Sets the heading: "uphill", "worst", "best", or an azimuth [deg] in [0, 360). Throws InputError for other texts,
/// with `where` first.
void set_heading(MapRules& rules, const std::string& text, const std::string& where);
/// "uphill heading", "heading 45 degrees from grid north", ...
std::string heading_text(const MapRules& rules);

/// What the model says about points of a soil that are equally likely.
struct Estimate {
  double p_go = 0;           // mean over the sampled points
  double outside_share = 1;  // share of the points that were not sampled or are too soft
  double soft_share = 0;     // share of the points that are too soft
  double soft_most = 1;      // the most that the mean P(go) of soft points may be
  double outside_most = 1;   // the same of those that were not sampled and are not soft
};

/// Answer of the model about a soil at one pair of slopes.
struct Prospect {
  std::vector<double> outcome;  // [outcome count] mean over the sampled points; zeros without any
  double outside_share = 1;     // as in Estimate, likewise the next three
  double soft_share = 0;
  double soft_most = 1, outside_most = 1;
  std::vector<double> bounding{};       // [outcome count] of the points whose P(go) bounds that of others; empty: none
  std::vector<Estimate> alternative{};  // of which the soil is one; empty: it is not divided

  double of(campaign::Verdict verdict) const;  // sum over its outcomes
  double p_go() const;                         // of the sampled points; NaN without any
  /// Weight of a no-go outcome among reasons: by its share of all points, sampled or bounded [-].
  double reason_weight(std::size_t outcome) const;
};

/// Bounds on P(go) of a soil.
struct PassageBounds {
  double lower = 0, upper = 1;  // of the mean over all of its points
  double least = 0, most = 1;   // of its alternatives: the least lower and the greatest upper one
};

struct CellClass {
  campaign::Verdict verdict = campaign::Verdict::unknown;
  campaign::Reason reason = campaign::Reason::outside_sampled;
};

/// soft_soil if at least half of outside_share is too soft; outside_sampled otherwise.
campaign::Reason reason_of_unknown(const Prospect& prospect);

/// Points that are too soft are never tolerated.
PassageBounds bounds_of(const Prospect& prospect, const MapRules& rules);

/// Class and reason of a cell. The reason of no_go is the likeliest one. That of unknown is reason_of_unknown() where
/// points are not sampled, and input_missing where only alternatives differ.
CellClass classify(const Prospect& prospect, const MapRules& rules);

/// Slope along the heading (uphill positive) and across it (left side up positive) [deg].
struct BedSlopes {
  double along = 0, across = 0;
};

/// psi: angle from the heading to the uphill direction of the fall line [rad], positive to the left (docs/notation.md).
struct FallLine {
  double cosine, sine;  // of psi
  explicit FallLine(double psi) : cosine(std::cos(psi)), sine(std::sin(psi)) {}
};

/// tan(along) = tan(slope) cos(psi), tan(across) = tan(slope) sin(psi). rise: tan(slope).
inline BedSlopes bed_slopes(double rise, const FallLine& line) {
  return {std::atan(rise * line.cosine) / kDegree, std::atan(rise * line.sine) / kDegree};
}
/// `slope`: of the ground [deg]. psi: as in FallLine.
inline BedSlopes bed_slopes(double slope, double psi) { return bed_slopes(std::tan(slope * kDegree), FallLine(psi)); }

/// psi [rad] for a heading [deg clockwise from grid north] on ground that falls towards `aspect` [deg, likewise].
inline double fall_line_angle(double heading, double aspect) { return (heading - aspect - 180) * kDegree; }

/// Aspect in whole degrees [0, 360). The map and its page round alike, so they look up the same entries.
inline double rounded_aspect(double aspect) { return std::fmod(std::round(aspect), 360.0); }

/// Number of headings that "worst" and "best" are taken over: 0 (uphill), 10, ... 350 degrees from the fall line.
inline constexpr int kHeadings = 36;

}  // namespace gonogo::map
