// Bodies whose ground is mapped, told apart by the radius of their coordinate systems.
#pragma once
#include <array>
#include <cmath>
#include <optional>

namespace gonogo::terrain {

struct Body {
  const char* name;
  const char* with_article;  // in a sentence
  double radius;             // equatorial or mean [m]
  double gravity;            // at the surface [m/s^2]
};

/// Radii: IAU Working Group on Cartographic Coordinates 2015 (Archinal et al., Celest. Mech. Dyn. Astron. 130:22,
/// 2018). Gravity: NASA planetary fact sheets (nssdc.gsfc.nasa.gov/planetary/factsheet); Titan's is GM over the radius
/// squared.
inline constexpr std::array<Body, 6> kBodies{{{"Earth", "the Earth", 6378137, 9.81},
                                              {"Moon", "the Moon", 1737400, 1.62},
                                              {"Mars", "Mars", 3396190, 3.71},
                                              {"Mercury", "Mercury", 2440530, 3.70},
                                              {"Venus", "Venus", 6051800, 8.87},
                                              {"Titan", "Titan", 2575000, 1.35}}};

/// By the radius [m] within 1 %.
inline std::optional<Body> body_of_radius(double radius) {
  for (const Body& body : kBodies)
    if (std::abs(radius / body.radius - 1) < 0.01) return body;
  return std::nullopt;
}

}  // namespace gonogo::terrain
