#include "terrain/soil/strength.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "base/units.h"

namespace gonogo::terrain {

const std::vector<std::string>& strength_test_names() {
  static const std::vector<std::string> names = {"triaxial", "direct_shear", "ring_shear", "plane_strain",
                                                 "repose",   "unconfined",   "plate",      "cone"};
  return names;
}

std::string name_of(StrengthTest test) { return strength_test_names()[std::size_t(test)]; }

StrengthTest strength_test_of(const std::string& name) {
  const auto& names = strength_test_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw InputError("\"" + name + "\" is no strength test (did you mean \"" + nearest_word(name, names) +
                     "\"?); use one of: " + join_words(names));
  return StrengthTest(found - names.begin());
}

std::string AngleMeaning::text() const {
  std::string name = name_of(test);
  std::replace(name.begin(), name.end(), '_', ' ');
  if (test == StrengthTest::repose) return "angle of repose";
  return name + (stage == Stage::peak ? ", peak" : ", residual");
}

double angle_on_plane(double triaxial, double dilation) {
  const double s = std::sin(to_radians(triaxial)), psi = to_radians(dilation);
  return to_degrees(std::atan(s * std::cos(psi) / (1 - s * std::sin(psi))));
}

double angle_of_triaxial(double on_plane, double dilation) {
  const double t = std::tan(to_radians(on_plane)), psi = to_radians(dilation);
  const double s = t / (std::cos(psi) + t * std::sin(psi));
  if (!(s < 1))
    throw InputError(
        line("soil: friction angle %g deg on the plane of shear at a dilation of %g deg: no soil has it, "
             "the most is %.1f deg; give a smaller angle, or the dilation that was measured",
             on_plane, dilation, angle_on_plane(90, dilation)));
  return to_degrees(std::asin(s));
}

double cohesion_on_plane(double triaxial, double dilation) {
  const double phi = to_radians(triaxial), psi = to_radians(dilation);
  return std::cos(phi) * std::cos(psi) / (1 - std::sin(phi) * std::sin(psi));
}

double cohesion_of_unconfined(double strength, double triaxial) {
  return 0.5 * strength * std::tan(kPi / 4 - to_radians(triaxial) / 2);
}

std::string readings_of(double angle) {
  std::string text = line("as triaxial compression it is %.3g deg", angle);
  if (std::tan(to_radians(angle)) < 1)
    text += line(", as direct or ring shear %.3g deg of triaxial compression", angle_of_triaxial(angle));
  return text + line(", as plane strain %.3g deg", angle / kPlaneStrainRatio);
}

}  // namespace gonogo::terrain
