// Obstacles of a region that are lines and polygons: rivers, ditches, stems, boulders, buildings; and roads over them.
//
// Geometry decides, and is said. The bounds are sufficient ones from statics. What lies between them is unknown, but
// for ditches of sizes that a model's trials sampled (pipeline/map/evaluate/outcome_model.h).
//
//   step h     A wheel of radius R and friction mu that nobody pushes stands on the edge under a vertical load. It
//              climbs if the edge's normal leans by at most atan(mu): h <= R (1 - 1 / sqrt(1 + mu^2)). At h >= R
//              the edge touches it at the axle or above: no-go. A belt counts by its front drum, and is no-go at 2 R.
//   ditch      A wheel sinks between the banks by min(depth, R - sqrt(R^2 - width^2 / 4)), by the depth where the
//              width is 2 R or more. That is the step to climb. Belts with their weight in the middle bridge half of
//              their length on the ground.
//   river      Shallower than the ground clearance it is waded like a ditch of no depth; deeper than 2 R: no-go.
//   stems      Between stems remain spacing - diameter. Narrower than the vehicle: no-go. As wide as it is long, so
//              that it may turn anywhere: the soil decides. Stems are not pushed over.
//   boulders   Height as a step, and under the clearance; otherwise as stems.
//   buildings  no-go.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "pipeline/campaign/study/contract.h"

namespace gonogo::map {

/// What crosses: numbers of a whole vehicle.
struct CrossingLimits {
  std::string vehicle;
  bool tracked = false;
  double radius = 0;                            // of a wheel, or of the front drum with its belt [m]
  double friction = 0;                          // of tyre or belt [-]
  double width = 0, length = 0, clearance = 0;  // [m]
  double contact_length = 0;                    // of a belt [m]
  // Sizes of ditches that trials of this vehicle sampled; empty ranges without a model of ditches [m].
  Range ditch_width{1, 0}, ditch_depth{1, 0};
};

/// `modelled`: between the bounds of a ditch, where trials of ditches answer.
enum class Crossing { passes, unknown, no_go, modelled };

Crossing cross_step(const CrossingLimits& v, double height);
Crossing cross_ditch(const CrossingLimits& v, double width, double depth);
Crossing cross_river(const CrossingLimits& v, double depth);
/// `gap`: between what stands there [m].
Crossing pass_between(const CrossingLimits& v, double gap);

/// A number, or the attribute of the features that holds it.
struct ObstacleNumber {
  std::string attribute;
  double value = 0;
  /// Throws InputError for a value of the attribute outside `allowed`.
  double of(const std::function<double(const std::string&)>& numbers, Range allowed, const std::string& where) const;
};

enum class ObstacleKind { river, ditch, stems, boulders, buildings, road };

struct Obstacle {
  ObstacleKind kind;
  std::string name;  // "ditch of ditches.gpkg"
  std::filesystem::path file;
  std::string layer;
  ObstacleNumber width, depth, spacing, diameter, height;  // [m]
  int road_soil = 0;                                       // code of a road's soil in Region::soils
  std::string source, licence;
};

inline constexpr Range kObstacleMetres{0, 10000};

/// Reads an entry of "obstacles"; a road's soil is read by the caller. Throws InputError.
Obstacle read_obstacle(const Config& config);

/// Size of a ditch [m].
struct DitchSize {
  double width = 0, depth = 0;
  auto operator<=>(const DitchSize&) const = default;
};

/// Width and depth of a ditch of this feature; throws InputError for values out of range.
DitchSize size_of(const Obstacle& ditch, const std::function<double(const std::string&)>& numbers);

/// How the vehicle fares at a feature. Without a vehicle it is unknown, but for buildings.
Crossing cross(const Obstacle& obstacle, const std::optional<CrossingLimits>& v,
               const std::function<double(const std::string&)>& numbers);

/// Reason of a cell that is not passed.
campaign::Reason reason_of(ObstacleKind kind, Crossing crossing);

}  // namespace gonogo::map
