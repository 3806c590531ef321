#include <cmath>

#include "base/error.h"
#include "base/line.h"
#include "sim/elastic/tyre/tyre.h"

namespace gonogo::sim::elastic {
namespace {

void need_positive(double value, const char* name, const char* unit) {
  if (!(value > 0) || !std::isfinite(value))
    throw InputError(line("tyre: %s is %g%s; it must be above 0", name, value, unit));
}

void need_not_negative(double value, const char* name, const char* unit) {
  if (!(value >= 0) || !std::isfinite(value))
    throw InputError(line("tyre: %s is %g%s; it must be 0 or above", name, value, unit));
}

}  // namespace

void check_tyre(const Tyre& t) {
  need_positive(t.radius, "radius", " m");
  need_positive(t.width, "width", " m");
  need_positive(t.bending, "bending stiffness of the belt", " N m^2");
  need_positive(t.stretching, "tensile stiffness of the belt", " N");
  need_not_negative(t.tread, "thickness of the tread", " m");
  need_not_negative(t.pressure, "pressure", " Pa");
  need_not_negative(t.radial, "radial stiffness of the sidewalls", " N/m^2");
  need_not_negative(t.tangential, "tangential stiffness of the sidewalls", " N/m^2");
  need_not_negative(t.belt_mass, "mass of the belt", " kg");
  if (!(t.rim_radius > 0 && t.rim_radius < t.belt_radius()))
    throw InputError(line("tyre: the rim's radius is %g m; it must lie between 0 and the belt's radius, %g m",
                          t.rim_radius, t.belt_radius()));
  const double chord = t.belt_radius() - t.rim_radius;
  if (!(t.bulge >= 0 && t.bulge <= chord / 2))
    throw InputError(
        line("tyre: the sidewall's bulge is %g m; allowed is 0 to half its height, %g m", t.bulge, chord / 2));
  if (!(t.loss >= 0 && t.loss <= 0.3))
    throw InputError(line("tyre: the loss factor is %g; allowed is 0 to 0.3", t.loss));
  if (t.nodes < 24 || t.nodes > 10000)
    throw InputError(line("tyre: the ring has %d nodes; allowed are 24 to 10000", t.nodes));
  check_law(t.law, 2, "tread");
}

}  // namespace gonogo::sim::elastic
