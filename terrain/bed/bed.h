// Granular beds. A packing settles without cohesion at low friction; its soil's contact law is switched on afterwards.
// A bed is a doubly periodic tile on a base of glued grains. On a smooth floor it would slide as a slab.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "sim/simulation/simulation.h"
#include "terrain/bed/clump.h"

namespace gonogo::terrain {

/// Materials of a bed world. `tool` acts on the bed: a tyre, a plate.
enum Material : int { grain_material = 0, base_material = 1, tool_material = 2 };

struct BedSpec {
  double length = 4, width = 0.8, depth = 0.3;  // of the settled bed along x, y, z [m]
  double grain_diameter = 0.09;                 // mean diameter of the sphere with a grain's volume [m]
  double size_spread = 0.1;                     // radii are uniform in mean * (1 +- spread)
  double grain_density = 2650;                  // of the solid [kg/m^3]; quartz
  double settle_friction = 0.1;                 // friction while settling: lower gives a denser packing
  double settle_rolling = 0;                    // rolling friction while settling: higher gives a looser packing
  std::uint64_t seed = 1;
  GrainShape shape = GrainShape::sphere;
  sim::Backend settled_on = sim::Backend::cpu;  // part of the spec, because each device gives other bits
  /// Hash of all that the packing depends on; its name in caches.
  std::string hash() const;
};

/// The geometry of a settled packing, without contact laws.
struct Packing {
  BedSpec spec{};
  std::vector<Grain> grain{};
  std::vector<Grain> base{};  // glued; spheres, or the lobes of clumps as spheres
  double surface = 0;         // mean height of the top, glued base at z = 0 [m]
  double solid_fraction = 0;  // from one grain above the base to one grain below the top [-]
  double residual_speed = 0;  // root-mean-square grain speed when settling stopped [m/s]
};

/// Contact laws of a bed: grain against grain (and base), and grain against the tool.
struct BedLaws {
  sim::PairLaw grain, tool;
};

/// Solver settings for grains of this diameter. Envelope, cohesion range and recovery speed scale with it.
sim::StepSettings bed_step_settings(double grain_diameter, double step, int iterations, double tolerance = 0);

/// Pours and settles a packing. Deterministic in spec. Throws InputError for sizes that cannot hold grains and
/// DeviceError when the grains do not come to rest.
Packing settle_packing(const BedSpec& spec, int threads);
/// Settles several packings of equal grains on one device, in one batch of worlds. Each has the bits of its own run.
/// `at_rest` is called every 100 steps with the number of packings at rest.
std::vector<Packing> settle_packings(const std::vector<BedSpec>& specs, int threads,
                                     const std::function<void(std::size_t)>& at_rest = {});

/// Path of this packing in `folder`.
std::filesystem::path packing_path(const BedSpec& spec, const std::filesystem::path& folder);

/// Reads the packing from `folder`, or settles it and stores it there.
Packing cached_packing(const BedSpec& spec, const std::filesystem::path& folder, int threads);

void write_packing(const std::filesystem::path& path, const Packing& packing);
Packing read_packing(const std::filesystem::path& path);

/// The same bed, shifted along its periodic axes and perhaps mirrored in y, as `seed` says: a variation without cost.
Packing shifted(const Packing& packing, std::uint64_t seed);

/// One larger periodic bed of `nx` by `ny` copies of a periodic tile.
Packing tiled(const Packing& tile, int nx, int ny);

/// A world with this bed. Bodies 0..n-1 are the grains in the packing's order; body n is the base. `headroom` is the
/// free height above the surface [m].
sim::SceneWorld bed_world(const Packing& packing, const BedLaws& laws, double headroom);

/// Lobes of all grains that are not glued, as spheres with centres inside the period.
std::vector<Grain> lobes_of(const Packing& packing);

/// Mean height of the spheres' upper surface over a grid of columns of this width [m].
double surface_height(const std::vector<Grain>& spheres, double length, double width, double column);

/// Height of the highest point of all grains [m].
double highest_point(const Packing& packing);

}  // namespace gonogo::terrain
