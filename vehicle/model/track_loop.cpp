#include "vehicle/model/track_loop.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "base/units.h"
#include "vehicle/model/statics.h"

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

/// An arc of the convex hull of circles: the interval of directions [rad] in which `circle` is the farthest.
struct HullArc {
  std::size_t circle = 0;
  double from = 0, to = 0;  // angle from x towards z; 0 <= from < to <= 2 pi
};

/// All arcs, sorted by direction. A circle may have several arcs, or none.
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

Vec3d toward(double angle) { return {std::cos(angle), 0, std::sin(angle)}; }

/// The boundary of circles' convex hull by its length, counterclockwise from x to z: arcs and the straight lines
/// between them.
class Hull {
 public:
  explicit Hull(const std::vector<Circle>& circles) {
    const std::vector<HullArc> arcs = hull_arcs(circles);
    for (std::size_t k = 0; k < arcs.size(); ++k) {
      const Circle& c = circles[arcs[k].circle];
      add({.begin = length_, .origin = {c.x, 0, c.z}, .radius = c.radius, .angle = arcs[k].from},
          c.radius * (arcs[k].to - arcs[k].from));
      const HullArc& next = arcs[(k + 1) % arcs.size()];
      const Circle& n = circles[next.circle];
      const Vec3d from = point(c, arcs[k].to), to = point(n, next.from), way = to - from;
      const double apart = gonogo::length(way);
      if (apart > 1e-12) add({.begin = length_, .origin = from, .way = way * (1 / apart)}, apart);
    }
  }

  double length() const { return length_; }

  Vec3d at(double s) const {
    s -= length_ * std::floor(s / length_);
    auto next = std::upper_bound(piece_.begin(), piece_.end(), s, [](double x, const Piece& p) { return x < p.begin; });
    const Piece& p = *(next - 1);
    if (p.radius > 0) return p.origin + p.radius * toward(p.angle + (s - p.begin) / p.radius);
    return p.origin + (s - p.begin) * p.way;
  }

 private:
  struct Piece {
    double begin = 0;
    Vec3d origin{};  // of an arc its middle, of a line its beginning
    double radius = 0, angle = 0;
    Vec3d way{};
  };

  static Vec3d point(const Circle& c, double angle) { return Vec3d{c.x, 0, c.z} + c.radius * toward(angle); }

  void add(const Piece& p, double length) {
    piece_.push_back(p);
    length_ += length;
  }

  std::vector<Piece> piece_;
  double length_ = 0;
};

/// The way along the hull to the next point at a straight distance of one pitch.
double next_pin(const Hull& hull, double s, double pitch) {
  const Vec3d from = hull.at(s);
  double low = s + 0.5 * pitch, high = s + 1.6 * pitch;  // half a circle of that pitch is longer by pi / 2
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (length(hull.at(middle) - from) < pitch ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

Vec3d idler_at(const Track& t, double tension) { return t.idler.centre + tension * (t.idler_travel - t.idler.centre); }

Hull hull_of(const Vehicle& v, bool left, double tension) {
  const Track& t = *v.track;
  const Vec3d idler = idler_at(t, tension);
  std::vector<Circle> circles{{t.sprocket.centre.x, t.sprocket.centre.z, t.sprocket_radius},
                              {idler.x, idler.z, pin_circle(t, t.idler_radius)}};
  for (const Station& s : stations(v))
    if ((s.side > 0) == left) circles.push_back({s.centre.x, s.centre.z, pin_circle(t, s.wheel->radius)});
  return Hull(circles);
}

/// Pins by chords from the sprocket's foremost point on; how far the last chord ends beyond the first pin [m].
double walk(const Vehicle& v, bool left, double tension, std::vector<Vec3d>* pin) {
  const Track& t = *v.track;
  const Hull hull = hull_of(v, left, tension);
  const int count = left ? t.left_shoes : t.right_shoes;
  double s = 0;
  for (int k = 0; k < count; ++k) {
    if (pin) pin->push_back(hull.at(s));
    s = next_pin(hull, s, t.shoe_pitch);
  }
  return s - hull.length();
}

/// Whether both loops close with their idlers within their travel.
bool closes(const Vehicle& v) {
  for (const bool left : {true, false})
    if (walk(v, left, 0, nullptr) < 0 || walk(v, left, 1, nullptr) > 0) return false;
  return true;
}

/// Turned about the y axis by an angle that takes z to x.
Vec3d turned_about_y(const Vec3d& v, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * v.x + s * v.z, v.y, -s * v.x + c * v.z};
}

Part turned_about_y(Part p, const Vec3d& pivot, double angle) {
  const double c = std::cos(angle), s = std::sin(angle), xx = p.moments.x, zz = p.moments.z, xz = p.products.y;
  p.centre = pivot + turned_about_y(p.centre - pivot, angle);
  p.moments.x = c * c * xx + 2 * c * s * xz + s * s * zz;
  p.moments.z = s * s * xx - 2 * c * s * xz + c * c * zz;
  p.products.y = c * s * (zz - xx) + (c * c - s * s) * xz;
  const double xy = p.products.x, yz = p.products.z;
  p.products.x = c * xy + s * yz;
  p.products.z = -s * xy + c * yz;
  return p;
}

/// An arm whose wheel lies `angle` lower about its pivot; its spring is less wound there.
Suspension turned_down(Suspension s, double angle) {
  const Vec3d pivot = s.point.at("pivot");
  const double about_y = s.point.at("wheel").x < pivot.x ? -angle : angle;
  for (const char* name : {"wheel", "arm_centre", "damper_arm"})
    if (const auto at = s.point.find(name); at != s.point.end())
      at->second = pivot + turned_about_y(at->second - pivot, about_y);
  s.part["arm"] = turned_about_y(s.part.at("arm"), pivot, about_y);
  s.torsion.preload -= s.torsion.stiffness * angle;
  return s;
}

/// How far an arm turns down from the design position until its spring carries a load on its wheel [rad].
double static_angle(const Suspension& s, double load) {
  double low = -1, high = 1;
  for (int k = 0; k < 60; ++k) {
    const double angle = 0.5 * (low + high);
    const Suspension at = turned_down(s, angle);
    const double lever = std::fabs(at.point.at("wheel").x - at.point.at("pivot").x);
    (at.torsion.preload > load * lever ? low : high) = angle;
  }
  return 0.5 * (low + high);
}

/// All arms turned down by a share of what their springs ask for.
Vehicle lowered(Vehicle v, double share) {
  const double load = (weigh(v).total - weigh(v).unsprung) * kGravity / double(stations(v).size());
  const double ground = weigh(v).ground;
  for (Suspension& s : v.suspension)
    if (s.type == SuspensionType::trailing_arm) s = turned_down(s, share * static_angle(s, load));
  v.clearance += ground - weigh(v).ground;
  return v;
}

}  // namespace

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
  const Track& t = *v.track;
  const Wheel& road = find_wheel(v, t.wheel);
  const Vec3d idler = t.idler.centre + tension * (t.idler_travel - t.idler.centre);
  std::vector<Circle> circles{{t.sprocket.centre.x, t.sprocket.centre.z, t.sprocket_radius},
                              {idler.x, idler.z, t.idler_radius + t.pad_above_pin}};
  for (const double x : left ? t.road_wheel_x : t.right_road_wheel_x)
    circles.push_back({x, t.road_wheel_z, road.radius + t.pad_above_pin});
  return convex_belt_length(circles);
}

int sprocket_teeth(const Track& t) {
  return int(std::lround(kPi / std::asin(std::min(1.0, 0.5 * t.shoe_pitch / t.sprocket_radius))));
}

double rolling_radius(const Track& t) { return sprocket_teeth(t) * t.shoe_pitch / (2 * kPi); }

double pin_circle(const Track& t, double wheel_radius) {
  return std::hypot(wheel_radius + t.pad_above_pin, 0.5 * t.shoe_pitch);
}

void check_sprocket(const Track& t, const std::string& where) {
  constexpr double tolerance = 5e-4;  // [m]
  const int teeth = sprocket_teeth(t);
  const double fits = 0.5 * t.shoe_pitch / std::sin(kPi / teeth);
  if (std::fabs(fits - t.sprocket_radius) > tolerance)
    throw InputError(where + "track.sprocket.radius_m: pins one pitch apart go around a circle of " +
                     number_text(fits, 5) + " m with " + std::to_string(teeth) + " teeth, it is " +
                     number_text(t.sprocket_radius, 5) + " m; make it the pitch over twice the sine of pi over the " +
                     "number of teeth, within 0.0005 m");
}

TrackLoop close_loop(const Vehicle& v, bool left) {
  const Track& t = *v.track;
  const double loose = walk(v, left, 0, nullptr), tight = walk(v, left, 1, nullptr);
  if (loose < 0 || tight > 0)
    throw InputError("vehicle " + v.name + ": the " + (left ? "left" : "right") + " belt of " +
                     std::to_string(left ? t.left_shoes : t.right_shoes) +
                     " shoes does not close: with the idler at the beginning of its travel it is " +
                     number_text(loose, 5) + " m longer than its way, at the end " + number_text(tight, 5) +
                     " m; the first must not be below zero, the second not above, change the count or the travel");
  double low = 0, high = 1;
  for (int k = 0; k < 50; ++k) {
    const double middle = 0.5 * (low + high);
    (walk(v, left, middle, nullptr) > 0 ? low : high) = middle;
  }
  TrackLoop loop;
  loop.tension = 0.5 * (low + high);
  loop.idler = idler_at(t, loop.tension);
  walk(v, left, loop.tension, &loop.pin);
  const Vec3d first = loop.pin[0] - t.sprocket.centre;
  loop.tooth_angle = std::atan2(first.z, first.x) + kPi / sprocket_teeth(t);
  return loop;
}

Vehicle set_down(Vehicle v) {
  if (v.kind != VehicleKind::tracked) return v;
  constexpr int parts = 20;
  for (int k = parts; k > 0; --k)
    if (Vehicle down = lowered(v, double(k) / parts); closes(down)) return down;
  return v;
}

}  // namespace gonogo::vehicle
