#include "pipeline/map/region/obstacle.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/format.h"

namespace gonogo::map {
namespace {

using Numbers = std::function<double(const std::string&)>;

/// The keys that a kind needs, in the order in which they are asked for.
std::vector<const char*> keys_of(ObstacleKind kind) {
  switch (kind) {
    case ObstacleKind::river:
    case ObstacleKind::ditch:
      return {"width_m", "depth_m"};
    case ObstacleKind::stems:
      return {"spacing_m", "diameter_m"};
    case ObstacleKind::boulders:
      return {"spacing_m", "diameter_m", "height_m"};
    case ObstacleKind::road:
      return {"width_m"};
    default:
      return {};
  }
}

ObstacleNumber read_number(const Config& config, const std::string& key) {
  const Json* value = config.json().find(key);
  if (value && value->is_string()) return {config.text(key), 0};
  return {"", config.number(key, kObstacleMetres)};
}

}  // namespace

double ObstacleNumber::of(const Numbers& numbers, Range allowed, const std::string& where) const {
  const double x = attribute.empty() ? value : numbers(attribute);
  if (!allowed.contains(x))
    throw InputError(where + ": " + attribute +
                     line(": is %g m, allowed are %g to %g; correct the file", x, allowed.minimum, allowed.maximum));
  return x;
}

Crossing cross_step(const CrossingLimits& v, double height) {
  if (height <= v.radius * (1 - 1 / std::sqrt(1 + v.friction * v.friction))) return Crossing::passes;
  return height >= (v.tracked ? 2 : 1) * v.radius ? Crossing::no_go : Crossing::unknown;
}

Crossing cross_ditch(const CrossingLimits& v, double width, double depth) {
  if (v.tracked && width <= 0.5 * v.contact_length) return Crossing::passes;
  const double half = 0.5 * width, r = v.radius;
  const double sag = v.tracked || half >= r ? depth : std::min(depth, r - std::sqrt(r * r - half * half));
  const Crossing crossing = cross_step(v, sag);
  const bool sampled = v.ditch_width.contains(width) && v.ditch_depth.contains(depth);
  return crossing == Crossing::unknown && sampled ? Crossing::modelled : crossing;
}

Crossing cross_river(const CrossingLimits& v, double depth) {
  if (depth <= v.clearance) return Crossing::passes;
  return depth >= 2 * v.radius ? Crossing::no_go : Crossing::unknown;
}

Crossing pass_between(const CrossingLimits& v, double gap) {
  if (gap < v.width) return Crossing::no_go;
  return gap >= v.length ? Crossing::passes : Crossing::unknown;
}

Obstacle read_obstacle(const Config& config) {
  const std::string kind =
      config.choice("kind", {"river", "ditch", "dry_river", "stems", "boulders", "buildings", "road"});
  const bool is_ditch = kind == "ditch" || kind == "dry_river";
  Obstacle o{.kind = kind == "river"      ? ObstacleKind::river
                     : is_ditch           ? ObstacleKind::ditch
                     : kind == "stems"    ? ObstacleKind::stems
                     : kind == "boulders" ? ObstacleKind::boulders
                     : kind == "road"     ? ObstacleKind::road
                                          : ObstacleKind::buildings,
             .name = kind,
             .file = config.path("file"),
             .layer = config.text_or("layer", ""),
             .width = {},
             .depth = {},
             .spacing = {},
             .diameter = {},
             .height = {},
             .source = config.text("source"),
             .licence = config.text("licence")};
  if (kind == "dry_river") o.name = "dry river";
  o.name += " of " + o.file.filename().string();
  for (const std::string key : keys_of(o.kind)) {
    ObstacleNumber& number = key == "width_m"      ? o.width
                             : key == "depth_m"    ? o.depth
                             : key == "spacing_m"  ? o.spacing
                             : key == "diameter_m" ? o.diameter
                                                   : o.height;
    number = read_number(config, key);
  }
  config.text_or("note", "");
  return o;
}

DitchSize size_of(const Obstacle& ditch, const Numbers& numbers) {
  const std::string where = ditch.file.string();
  return {ditch.width.of(numbers, kObstacleMetres, where), ditch.depth.of(numbers, kObstacleMetres, where)};
}

Crossing cross(const Obstacle& o, const std::optional<CrossingLimits>& v, const Numbers& numbers) {
  if (o.kind == ObstacleKind::buildings) return Crossing::no_go;
  if (o.kind == ObstacleKind::road) return Crossing::passes;
  const auto metres = [&](const ObstacleNumber& n) { return n.of(numbers, kObstacleMetres, o.file.string()); };
  const double width = metres(o.width), depth = metres(o.depth), height = metres(o.height);
  const double gap = metres(o.spacing) - metres(o.diameter);
  if (!v) return Crossing::unknown;
  switch (o.kind) {
    case ObstacleKind::river:
      return cross_river(*v, depth);
    case ObstacleKind::ditch:
      return cross_ditch(*v, width, depth);
    case ObstacleKind::boulders:
      if (height <= v->clearance && cross_step(*v, height) == Crossing::passes) return Crossing::passes;
      return pass_between(*v, gap);
    default:
      return pass_between(*v, gap);
  }
}

campaign::Reason reason_of(ObstacleKind kind, Crossing crossing) {
  if (kind == ObstacleKind::river) return campaign::Reason::water;
  if (kind == ObstacleKind::stems) return campaign::Reason::vegetation;
  if (kind == ObstacleKind::buildings) return campaign::Reason::built_up;
  return crossing == Crossing::no_go ? campaign::Reason::obstacle : campaign::Reason::outside_sampled;
}

}  // namespace gonogo::map
