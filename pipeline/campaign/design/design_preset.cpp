#include "pipeline/campaign/design/design_preset.h"

namespace gonogo::campaign {

std::vector<std::string> preset_names() { return {"study_reproduction", "realistic_soil"}; }

DesignPreset design_preset(const std::string& name) {
  if (name == "study_reproduction")
    return {.ranges = {{"slope_along", {0, 30}}, {"friction_angle", {11.3, 45}}, {"cohesion", {0, 100}}},
            .fixed = {{"slope_across", 0},
                      {"relative_density", 0.5},
                      {"payload", 0},
                      {"tyre_friction", 0.8},
                      {"bed_depth", 0.1},
                      {"commanded_speed", 1.1}}};
  if (name == "realistic_soil")
    return {.ranges = {{"slope_along", {-35, 35}},
                       {"slope_across", {-15, 15}},
                       {"friction_angle", {20, 42}},
                       {"cohesion", {0, 25}},
                       {"relative_density", {0, 1}}},
            .fixed = {{"payload", 0}, {"tyre_friction", 0.8}, {"bed_depth", 0.3}, {"commanded_speed", 1.5}}};
  return {};
}

}  // namespace gonogo::campaign
