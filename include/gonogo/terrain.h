// Settled beds of grains, and soils by name or by friction angle and cohesion. Link gonogo::terrain.
//
// A bed is a tile, periodic along x and y, on a base of glued grains whose mean top is at z = 0.
#pragma once
#include <gonogo/sim.h>

namespace gonogo::api {

/// Materials of a bed's world. The tool acts on the bed: a tyre, a plate.
inline constexpr int kGrainMaterial = 0, kBaseMaterial = 1, kToolMaterial = 2;

struct BedSettings {
  double length = 4, width = 0.8, depth = 0.3;  // along x, y, z [m]
  double grain_diameter = 0.09;                 // of the sphere with a grain's mean volume [m]
  double size_spread = 0.1;                     // radii are uniform in mean * (1 +- spread) [-]
  double grain_density = 2650;                  // of the solid [kg/m^3]
  double settle_friction = 0.1;                 // while settling: lower gives a denser bed [-]
  std::string grain_shape = "sphere";           // or "pair", "trefoil": clumps of two or three spheres
  std::uint64_t seed = 1;
};

/// A settled bed without contact laws. Cheap to copy.
class Bed {
 public:
  struct Impl;
  explicit Bed(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}

  /// Pours and settles grains; deterministic in `settings`. Throws InputError for sizes that hold no grains,
  /// DeviceError when they do not come to rest.
  static Bed settle(const BedSettings& settings, int threads = 1);
  static Bed read(const std::filesystem::path& file);
  void write(const std::filesystem::path& file) const;

  /// The same bed moved along its periodic axes and perhaps mirrored in y, as `seed` says: a variation without cost.
  Bed shifted(std::uint64_t seed) const;
  /// One bed of nx by ny copies.
  Bed tiled(int nx, int ny) const;

  const BedSettings& settings() const;
  int grain_count() const;
  double solid_fraction() const;  // [-]
  double surface() const;         // mean height of the top [m]
  double highest_point() const;   // [m]

  /// A world with this bed: bodies 0 to grain_count() - 1 are the grains, then the base. `headroom`: free height above
  /// the surface [m].
  World world(const ContactLaw& between_grains, const ContactLaw& grain_on_tool, double headroom = 2) const;
  /// Settings that suit grains of this size. `step` [s], `tolerance` [m/s].
  StepSettings step_settings(double step = 1e-3, int iterations = 50, double tolerance = 0) const;

 private:
  std::shared_ptr<const Impl> impl_;
};

/// A soil as a laboratory describes it.
struct Soil {
  double friction_angle = 0;      // of the test that is named below; by itself the peak of triaxial compression [deg]
  double cohesion = 0;            // [Pa]
  double bulk_density = 0;        // [kg/m^3]; 0: not given
  double relative_density = 0;    // from 0, loosest, to 1, densest [-]
  std::string test = "triaxial";  // or "direct_shear", "ring_shear", "plane_strain", "repose"
  bool residual = false;          // the angle after the peak
  double dilation = 0;            // that was measured at it [deg]
};

/// The same soil in numbers of triaxial compression, peak, without dilation beyond what it names.
Soil as_triaxial(const Soil& soil);

/// A soil of a file at one moisture. Properties are uniformly distributed over their ranges.
struct SoilState {
  std::string name{}, texture{}, moisture{};
  Range friction_angle{}, cohesion{}, bulk_density{}, relative_density{};  // units as in Soil
  Soil middle() const;
  std::string test = "triaxial";  // of the friction angle, as in Soil
  bool residual = false;
  double dilation = 0;
};

/// States of a soil's file, or of a shipped soil ("sandy_loam", "usda").
std::vector<SoilState> read_soil(const std::string& name_or_file);

/// Grains that act as a soil: their contact law, and the bed that they settle to.
struct SoilGrains {
  ContactLaw law{};
  BedSettings bed{};                // size of the tile as BedSettings; the rest is the soil's
  Soil reached{};                   // by the table
  double friction_angle_error = 0;  // standard error [deg]
  double cohesion_error = 0;        // [Pa]
};

/// A calibration: measured friction angles and cohesions over contact parameters, for one size of grains.
class SoilTable {
 public:
  struct Impl;
  /// A file, or a shipped table: "calibration_90mm", "calibration_32mm".
  static SoilTable read(const std::string& name_or_file = "calibration_90mm");

  double grain_diameter() const;  // [m]
  Range friction_angles() const;  // that every density reaches [deg]
  /// Throws InputError that states the reachable range when the table does not cover the soil.
  SoilGrains grains(const Soil& soil) const;

 private:
  explicit SoilTable(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
  std::shared_ptr<const Impl> impl_;
};

/// USDA texture class of shares by mass [%], which add up to 100: "sandy loam".
std::string usda_texture(double sand, double silt, double clay);
/// Cone index of fine-grained soil [Pa], to be compared with Vehicle::cone_index().
double cone_index(const Soil& soil);

}  // namespace gonogo::api
