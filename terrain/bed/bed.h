// Granular beds. A packing settles without cohesion at low friction; its soil's contact law is switched on afterwards.
// A bed is a doubly periodic tile on a base of glued grains. On a smooth floor it would slide as a slab.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/json/json.h"
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

/// Numerics of trials, and of the soil tests behind their table: a measured friction angle holds for its numerics only
/// (docs/soils.md).
struct Numerics {
  double step = 2e-3;       // [s]
  int substeps = 1;         // of a step
  int iterations = 200;     // max in a substep
  double tolerance = 5e-3;  // residual at which the solver stops; 0: never [m/s]
  sim::Target target = sim::Target::ccp;
  sim::ContactLaw contact =
      sim::ContactLaw::complementarity;  // or a law of the penalty family, which takes whole steps
  double overlap = 0.02;  // penalty: largest, as a share of the radius, in an impact at kOverlapSpeed [-]
  double give = 0;        // of contacts of complementarity, see sim::counted_gap; 0: rigid [-]
};

/// Numerics of the shipped tables: one update in each substep of 25 microseconds for grains of 32 mm, in proportion to
/// the diameter for others, with give. Beds hold still, and friction angles are those of many updates within a degree
/// (docs/log/creep.md). With the same number of updates these contacts are the stiffest: the overlap over the diameter
/// grows as the stress times the square of substep over diameter.
Numerics usual_numerics(double grain_diameter);

/// Speed of the impact for which penalty contact is made stiff enough [m/s].
inline constexpr double kOverlapSpeed = 2;
/// Coefficient of restitution of penalty contact between grains [-].
inline constexpr double kPenaltyRestitution = 0.3;

inline bool operator==(const Numerics& a, const Numerics& b) {
  return a.step == b.step && a.substeps == b.substeps && a.iterations == b.iterations && a.tolerance == b.tolerance &&
         a.target == b.target && a.contact == b.contact && a.overlap == b.overlap && a.give == b.give;
}

sim::StepSettings step_settings(double grain_diameter, const Numerics& n);

/// "step 0.006 s, 14 x 2 updates to 0 m/s, coulomb"; without the target when it is ccp. Different numerics differ here.
std::string description(const Numerics& n);

/// Writes the keys of a study's `numerics`: step_s, substeps, iterations, tolerance_m_per_s, target unless ccp, give
/// unless 0, and contact and overlap unless complementarity.
void write_numerics(Json& object, const Numerics& n);
/// Whether the keys are there that every object of numerics has: the first four.
bool states_numerics(const Json& object);
/// Reads the same keys.
Numerics read_numerics(const Json& object);

/// One settled packing serves every depth of soft soil: the packing with a hard layer `depth` [m] below its surface.
/// Grains with deeper centres become the rough base; those that nothing above can touch are left out. z = 0 is the top
/// of the hard layer. The packing is returned unchanged unless it is deeper than `depth` by half a grain.
Packing on_hard_layer(const Packing& packing, double depth);

/// An endless bed for a vehicle that moves along x. On a periodic bed, the ground far ahead of the vehicle and the
/// ground far behind it are the same place. The grains there are put back to their positions at the start, at rest. The
/// vehicle always drives onto undisturbed ground, and the cost does not grow with the distance.
struct MovingPatch {
  double length = 0;  // period of the bed [m]
  double reach = 0;   // grains that started within this distance of the vehicle along x are left alone [m]
};

/// Throws InputError for a bed so short that no slab is left to renew.
void check_patch(const MovingPatch& patch, double grain_diameter);

/// Pose of a grain at the start.
struct GrainPlace {
  Vec3d position;         // [m]
  Quat orientation = {};  // of clumps
};

/// Present poses of the first `count` bodies, which are grains of this shape.
std::vector<GrainPlace> grain_places(const std::vector<sim::BodyState>& bodies, GrainShape shape, std::size_t count);

/// Grains that started beyond the reach of a vehicle at `x`.
std::vector<sim::BodyIndex> virgin_grains(const MovingPatch& patch, const std::vector<GrainPlace>& start, double x);

/// Puts the virgin grains back. Bodies 0 .. start.size() - 1 of the world are the grains. The result depends on `x`
/// alone; a second call with the same `x` changes nothing.
void renew_ground(sim::Simulation& simulation, sim::WorldIndex world, const MovingPatch& patch,
                  const std::vector<GrainPlace>& start, double x);

}  // namespace gonogo::terrain
