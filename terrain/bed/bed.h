// Granular beds: packings settled without cohesion at low friction, whose properties are switched on afterwards.
// A bed is a doubly periodic tile on a base of glued grains; a smooth floor would let it slide as a slab.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "sim/simulation/simulation.h"
#include "terrain/bed/clump.h"

namespace gonogo::terrain {

/// Materials of a bed world. `tool` is whatever acts on the bed: a tyre, a plate.
enum Material : int { grain_material = 0, base_material = 1, tool_material = 2 };

struct BedSpec {
  double length = 4, width = 0.8, depth = 0.3;  // of the settled bed along x, y, z [m]
  double grain_diameter = 0.09;                 // mean, of the sphere with a grain's volume [m]
  double size_spread = 0.1;                     // radii are uniform in mean * (1 +- spread)
  double grain_density = 2650;                  // of the solid [kg/m^3]; quartz
  double settle_friction = 0.1;                 // while settling: the lower, the denser the packing
  double settle_rolling = 0;                    // rolling friction while settling: makes packings looser still
  std::uint64_t seed = 1;
  GrainShape shape = GrainShape::sphere;
  sim::Backend settled_on = sim::Backend::cpu;  // grains come to rest elsewhere on another device
  /// Name that identifies the packing and everything that made it.
  std::string hash() const;
};

/// A settled packing, loose of any property but geometry.
struct Packing {
  BedSpec spec{};
  std::vector<Grain> grain{};
  std::vector<Grain> base{};  // glued; spheres, also where they are lobes
  double surface = 0;         // mean height of the top, glued base at z = 0 [m]
  double solid_fraction = 0;  // of the bed between a grain above the base and a grain below the top [-]
  double residual_speed = 0;  // root-mean-square grain speed when settling stopped [m/s]
};

/// Contact laws of a bed: grain against grain (and base), and grain against the tool.
struct BedLaws {
  sim::PairLaw grain, tool;
};

/// Numerical parameters for grains of this diameter: envelope, cohesion range and recovery speed scale with it.
sim::StepSettings bed_step_settings(double grain_diameter, double step, int iterations, double tolerance = 0);

/// Pours and settles a packing. Deterministic in spec. Throws InputError for sizes that cannot hold grains and
/// DeviceError when the grains do not come to rest.
Packing settle_packing(const BedSpec& spec, int threads);
/// Several in one batch of worlds, each with the bits that it has alone: of the same grains, on the same device.
/// `at_rest` is told now and then how many of them are.
std::vector<Packing> settle_packings(const std::vector<BedSpec>& specs, int threads,
                                     const std::function<void(std::size_t)>& at_rest = {});

/// Where `folder` keeps the packing of this specification.
std::filesystem::path packing_path(const BedSpec& spec, const std::filesystem::path& folder);

/// The packing from `folder` when it is there, otherwise settled and stored there.
Packing cached_packing(const BedSpec& spec, const std::filesystem::path& folder, int threads);

void write_packing(const std::filesystem::path& path, const Packing& packing);
Packing read_packing(const std::filesystem::path& path);

/// The same bed as seen after a shift along the periodic axes and an optional mirror image in y: a free variation.
Packing shifted(const Packing& packing, std::uint64_t seed);

/// `nx` by `ny` copies of a periodic tile side by side: one larger periodic bed.
Packing tiled(const Packing& tile, int nx, int ny);

/// A world with this bed: bodies 0..n-1 are the grains in the packing's order, body n is the base. `headroom` is left
/// free above the surface [m].
sim::SceneWorld bed_world(const Packing& packing, const BedLaws& laws, double headroom);

/// All lobes of the grains that are not glued, as spheres; their centres lie inside the period.
std::vector<Grain> lobes_of(const Packing& packing);

/// Mean height of the top of spheres over a grid of columns one grain wide [m].
double surface_height(const std::vector<Grain>& spheres, double length, double width, double column);

/// Height of the highest point of a grain [m].
double highest_point(const Packing& packing);

}  // namespace gonogo::terrain
