#include "terrain/raster/vector/geojson.h"

#include <algorithm>
#include <sstream>

#include "base/json/json.h"

namespace gonogo::terrain {
namespace {

bool holds_anything(const Json& value) {
  if (value.is_array()) return std::any_of(value.items().begin(), value.items().end(), holds_anything);
  if (!value.is_object()) return true;
  const auto& members = value.members();
  return std::any_of(members.begin(), members.end(), [](const auto& member) { return holds_anything(member.second); });
}

bool states_shape(const Json& feature) {
  const Json* shape = feature.is_object() ? feature.find("geometry") : nullptr;
  if (!shape || shape->is_null()) return false;
  if (!shape->is_object()) return true;
  const auto& members = shape->members();
  return std::any_of(members.begin(), members.end(),
                     [](const auto& member) { return member.first != "type" && holds_anything(member.second); });
}

std::uint64_t in_collection(const Json& root) {
  const Json* features = root.is_object() ? root.find("features") : nullptr;
  if (!features || !features->is_array()) return states_shape(root);
  return std::uint64_t(std::count_if(features->items().begin(), features->items().end(), states_shape));
}

}  // namespace

std::uint64_t stated_shapes(const std::string& text, bool by_lines, const std::string& name) {
  if (!by_lines) return in_collection(Json::parse(text, name));
  std::istringstream lines(text);
  std::uint64_t count = 0;
  for (std::string line; std::getline(lines, line);) {
    std::erase(line, '\x1e');  // begins a record of RFC 8142
    if (line.find_first_not_of(" \t\r") != std::string::npos) count += in_collection(Json::parse(line, name));
  }
  return count;
}

}  // namespace gonogo::terrain
