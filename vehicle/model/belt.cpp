#include "vehicle/model/belt.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"

namespace gonogo::vehicle {
namespace {

/// Angle of direction t turned into [0, 2 pi).
double full_turn(double angle) {
  angle = std::fmod(angle, 2 * kPi);
  return angle < 0 ? angle + 2 * kPi : angle;
}

/// How far a circle reaches in a direction [m].
double reach(const Circle& c, double direction) {
  return c.x * std::cos(direction) + c.z * std::sin(direction) + c.radius;
}

}  // namespace

std::vector<HullArc> hull_arcs(const std::vector<Circle>& circles) {
  std::vector<double> turn{0};
  for (std::size_t i = 0; i < circles.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double x = circles[i].x - circles[j].x, z = circles[i].z - circles[j].z, apart = std::hypot(x, z);
      const double cosine = (circles[j].radius - circles[i].radius) / apart;
      if (!(std::fabs(cosine) <= 1)) continue;  // one is inside the other
      for (const int side : {-1, 1}) turn.push_back(full_turn(std::atan2(z, x) + side * std::acos(cosine)));
    }
  std::sort(turn.begin(), turn.end());
  turn.push_back(2 * kPi);
  // Between the directions in which two circles reach equally far one circle is outermost.
  std::vector<HullArc> arcs;
  for (std::size_t i = 1; i < turn.size(); ++i) {
    const double middle = 0.5 * (turn[i - 1] + turn[i]);
    const auto outer = std::max_element(circles.begin(), circles.end(), [&](const Circle& p, const Circle& q) {
      return reach(p, middle) < reach(q, middle);
    });
    const auto circle = std::size_t(outer - circles.begin());
    if (!arcs.empty() && arcs.back().circle == circle)
      arcs.back().to = turn[i];
    else
      arcs.push_back({circle, turn[i - 1], turn[i]});
  }
  return arcs;
}

double convex_belt_length(const std::vector<Circle>& circles) {
  // Cauchy: the perimeter is the integral of the support function over all directions; over an arc it is exact.
  double length = 0;
  for (const HullArc& arc : hull_arcs(circles)) {
    const Circle& outer = circles[arc.circle];
    const double a = arc.from, b = arc.to;
    length += outer.x * (std::sin(b) - std::sin(a)) - outer.z * (std::cos(b) - std::cos(a)) + outer.radius * (b - a);
  }
  return length;
}

double belt_length(const Vehicle& v, bool left, double tension) {
  const Track& t = v.track[0];
  const Wheel& road = find_wheel(v, t.wheel);
  const Vec3d idler = t.idler.centre + tension * (t.idler_travel - t.idler.centre);
  std::vector<Circle> circles{{t.sprocket.centre.x, t.sprocket.centre.z, t.sprocket_radius},
                              {idler.x, idler.z, t.idler_radius + t.pad_above_pin}};
  for (const double x : left ? t.road_wheel_x : t.right_road_wheel_x)
    circles.push_back({x, t.road_wheel_z, road.radius + t.pad_above_pin});
  return convex_belt_length(circles);
}

}  // namespace gonogo::vehicle
