// Soils: texture classes, cone index, and soil files (configs/soils/*.json, schema configs/schema/soil.json) with
// macroscopic properties at one or more moistures, each a value or a range with its source.
#pragma once
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/units.h"
#include "terrain/soil/calibration.h"

namespace gonogo::terrain {

/// Texture class of shares by mass of the particles below 2 mm [%], which add up to 100. One of usda_textures().
/// Source: Soil Science Division Staff, Soil Survey Manual, USDA Handbook 18 (2017), chapter 3, texture classes.
inline std::string usda_texture(double sand, double silt, double clay) {
  if (silt + 1.5 * clay < 15) return "sand";
  if (silt + 2 * clay < 30) return "loamy sand";
  if (clay >= 40) return sand > 45 ? "sandy clay" : silt >= 40 ? "silty clay" : "clay";
  if (clay >= 35 && sand > 45) return "sandy clay";
  if (clay >= 27) {
    if (sand > 45) return silt < 28 ? "sandy clay loam" : "clay loam";
    return sand > 20 ? "clay loam" : "silty clay loam";
  }
  if (silt >= 80 && clay < 12) return "silt";
  if (silt >= 50) return "silt loam";
  if (clay >= 20 && silt < 28) return "sandy clay loam";
  if (clay < 7 || sand > 52) return "sandy loam";
  return "loam";
}

/// The twelve texture classes of the USDA: names in lower case, from coarse to fine.
inline const std::vector<std::string>& usda_textures() {
  static const std::vector<std::string> names = {
      "sand", "loamy sand", "sandy loam",      "sandy clay loam", "loam",       "silt loam",
      "silt", "clay loam",  "silty clay loam", "sandy clay",      "silty clay", "clay"};
  return names;
}

/// The textures in the order of their codes 1 to 12 in rasters, as NRCS SSURGO derivatives and configs/regions have it:
/// 1 sand to 12 clay.
inline const std::vector<std::string>& usda_texture_codes() {
  static const std::vector<std::string> names = {
      "sand",      "loamy sand",      "sandy loam", "loam",       "silt loam", "silt", "sandy clay loam",
      "clay loam", "silty clay loam", "sandy clay", "silty clay", "clay"};
  return names;
}

/// Classes of the Unified Soil Classification System without the organic ones, from coarse to fine.
inline const std::vector<std::string>& uscs_classes() {
  static const std::vector<std::string> names = {"GW", "GP", "GM", "GC", "SW", "SP",
                                                 "SM", "SC", "ML", "CL", "MH", "CH"};
  return names;
}

/// Fine-grained in the sense of the cone index: more than half passes the 0.075 mm sieve (FM 5-430-00-1, chapter 7).
/// The triangle's silt and clay end at 0.05 mm, so that a class counts from a middle of its area of 48 % silt and clay
/// on: sandy clay is the coarsest of them; sandy clay loam (40 %) and what lies before it in the list are not. USCS
/// classes of silt and clay are fine-grained by definition.
inline bool is_fine_grained(const std::string& texture) {
  const auto& classes = uscs_classes();
  if (const auto at = std::find(classes.begin(), classes.end(), texture); at != classes.end())
    return at - classes.begin() >= 8;
  const auto& all = usda_textures();
  const auto place = std::find(all.begin(), all.end(), texture) - all.begin();
  return place >= 4 && place < std::ptrdiff_t(all.size());
}

/// Bearing capacity factor of cohesion under a strip (Prandtl 1921): (e^(pi tan phi) tan^2(45 + phi/2) - 1) cot phi;
/// 2 + pi without friction. `friction_angle` [deg].
inline double bearing_capacity_factor(double friction_angle) {
  const double phi = to_radians(friction_angle);
  if (phi < 1e-6) return 2 + kPi;
  const double half = std::tan(kPi / 4 + phi / 2);
  return (std::exp(kPi * std::tan(phi)) * half * half - 1) / std::tan(phi);
}

/// Bearing capacity factor of the load beside a strip (Reissner 1924): e^(pi tan phi) tan^2(45 + phi/2); 1 without
/// friction. `friction_angle` [deg].
inline double surcharge_factor(double friction_angle) {
  return 1 + bearing_capacity_factor(friction_angle) * std::tan(to_radians(friction_angle));
}

/// Overburden [Pa] at 6 inches: the middle of the layer from 3 to 9 inches in which cone indices are read for wheel
/// loads below 2,000 lb (ERDC/GSL SR-13-2). 1,500 kg/m^3 is a light moist soil.
inline constexpr double kOverburden = 1500 * kGravity * 0.1524;

/// Cone index of fine-grained soil [Pa], which is compared with the vehicle cone indices VCI1 and VCI50: Terzaghi's sum
/// of the bearing capacities of cohesion and overburden. Depth and round shape raise the strip's factor of cohesion
/// from 5.14 to 9 (Skempton 1951, "The bearing capacity of clays"). The factor of overburden is not raised, so that the
/// index is an underestimate. `cohesion` [Pa], `friction_angle` [deg].
inline double cone_index(double cohesion, double friction_angle) {
  const double of_cohesion = 9 / (2 + kPi) * bearing_capacity_factor(friction_angle) * cohesion;
  return of_cohesion + surcharge_factor(friction_angle) * kOverburden;
}

/// A property: uniformly distributed from low to high.
struct SoilValue {
  double low = 0, high = 0;
  std::string source, no_source, note;  // `source` or `no_source` is set

  double middle() const { return (low + high) / 2; }
  bool fixed() const { return low == high; }
};

struct Bekker {
  SoilValue n, k_c, k_phi;  // [-], [kN/m^(n+1)], [kN/m^(n+2)]
};

/// A strength test of a soil, with what it shows.
struct SoilTest {
  AngleMeaning meaning;
  std::optional<SoilValue> friction_angle{}, cohesion{};   // [deg], [kPa]
  std::optional<SoilValue> unconfined_strength{};          // [kPa]
  std::optional<SoilValue> cone_index{}, cone_gradient{};  // [kPa], [kPa/m]
  std::optional<Bekker> bekker{};                          // of plates
  std::optional<SoilValue> janosi{};                       // K of Janosi and Hanamoto [mm]
  std::optional<Range> normal_stress{};                    // of triaxial compression the lateral one [kPa]
  double cone_area = 323;                                  // base of the cone [mm^2]
  Range cone_depth{0, 0.1524};                             // over which an index is the mean [m]
  std::vector<double> plate_widths{};                      // smaller sides [m]; empty: not given
};

struct SoilState {
  std::string name, texture, moisture, note;  // texture: of the USDA, or class of the USCS
  std::optional<double> water_percent;
  SoilValue bulk_density;      // [kg/m^3]
  SoilValue relative_density;  // [-]
  /// Of the file's first test that shows a friction angle. Others are evidence beside it.
  SoilValue friction_angle;  // [deg]
  SoilValue cohesion;        // [kPa]
  AngleMeaning meaning;
  std::optional<Bekker> bekker;     // of the first test of plates
  std::optional<SoilValue> janosi;  // of the first test that gives it
  std::vector<SoilTest> tests;

  /// The middle of every range.
  MacroscopicSoil macroscopic() const;
};

struct SoilFile {
  std::string name, about;
  std::vector<SoilState> states;
  Json fits;  // by name of the table; null if there are none
};

/// Reads gonogo/soil/2, and gonogo/soil/1, whose friction angles are those of triaxial compression. Throws InputError
/// for files that the schema does not allow.
SoilFile read_soil(const std::filesystem::path& path);

/// Fit of a state by a table: contact law, density of the solid and mismatches, or why there is no fit.
Json fit_record(const Calibration& calibration, const SoilState& state);

/// Writes the fits of all states by this table into the file, in place of earlier fits by a table of that name.
void write_fits(const std::filesystem::path& path, const std::string& table, const Calibration& calibration);

}  // namespace gonogo::terrain
