#include "pipeline/map/region/ground_gravity.h"

#include <cmath>

#include "base/error.h"
#include "base/line.h"
#include "terrain/raster/body.h"

namespace gonogo::map {
namespace {

constexpr double kTolerance = 0.02;

/// "the Moon", or the radius of a body that has no name here.
std::string body_text(double radius) {
  const auto body = terrain::body_of_radius(radius);
  return body ? body->with_article : line("a body with a radius of %.0f km", radius / 1e3);
}

}  // namespace

std::string gravity_text(double gravity) { return line("%.4g m/s2", gravity); }

bool is_same_gravity(double a, double b) { return std::abs(a / b - 1) <= kTolerance; }

double ground_gravity(const Region& region, double body_radius) {
  const auto body = terrain::body_of_radius(body_radius);
  const std::string place = region.file.string() + ": gravity: ";
  if (!region.gravity) {
    if (body) return body->gravity;
    throw InputError(place + "is missing, and the elevation lies on " + body_text(body_radius) +
                     ", which this program does not know; give a region file with \"gravity\" [m/s2]");
  }
  if (body && !is_same_gravity(*region.gravity, body->gravity))
    throw InputError(place + "is " + gravity_text(*region.gravity) + ", and the elevation lies on " +
                     body_text(body_radius) + ", which has " + gravity_text(body->gravity) +
                     "; leave it out, or give ground of that gravity");
  return *region.gravity;
}

void require_gravity(const Region& region, double body_radius, double of_trials) {
  const double ground = ground_gravity(region, body_radius);
  if (is_same_gravity(ground, of_trials)) return;
  throw InputError(region.elevation.files.name() + ": lies on " + body_text(body_radius) + " with a gravity of " +
                   gravity_text(ground) + ", and the trials of the model had " + gravity_text(of_trials) +
                   line("; give a model of trials whose study says \"gravity\": %.4g, or ground of %s", ground,
                        gravity_text(of_trials).c_str()));
}

}  // namespace gonogo::map
