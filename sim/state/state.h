// Arrays of a batch of worlds. A world is a box, periodic along x and y if asked. Its bodies and shapes are contiguous
// and always in the same order, so that its result does not depend on the other worlds of the batch.
#pragma once
#include "base/for_each.h"
#include "sim/state/contact.h"
#include "sim/state/elements.h"
#include "sim/state/fault.h"
#include "sim/state/mechanism.h"
#include "sim/state/momentum.h"
#include "sim/state/surface_store.h"

namespace gonogo::sim {

/// How two materials touch.
struct PairLaw {
  Real friction = 0;           // sliding, [-]
  Real rolling_friction = 0;   // [-], times the sphere's effective radius
  Real cohesion_pressure = 0;  // tensile strength on the area pi r^2 of the smaller sphere or capsule [Pa]
  Real spinning_friction = 0;  // [-], times the sphere's effective radius
  Real stiffness = 0;          // of a compliant contact along its normal [N/m]; 0: rigid
  Real damping = 0;            // of a compliant contact along its normal [N s/m]
};

/// Numerical parameters of a step, the same for all worlds of a batch.
struct StepSettings {
  Real step = 1e-3f;              // [s]
  Index iterations = 100;         // max iterations of the solver in a substep
  Real tolerance = 0;             // root-mean-square residual at which a world stops iterating [m/s]; 0: never
  Real envelope = 2e-3f;          // contacts are found up to this gap [m]
  Real recovery_speed = 0.1f;     // overlaps are pushed out no faster than this [m/s]
  Real recovery_share = 0.2f;     // share of an overlap pushed out in one step
  Real cohesion_range = 0.5e-3f;  // cohesion acts up to this gap [m]
  Solver solver = Solver::apgd;
  Target target = Target::ccp;
  Index substeps = 1;       // into which the solver divides a step; see step.h
  Index sort_every = 2000;  // steps of a world after which its bodies are sorted in memory, if they have mixed
  /// How often a world may slow a free body (one without joints) to one bin per step before flag_too_fast stops it. A
  /// grain pinched between two rigid bodies can leave at more than 30 m/s at any step size.
  Index max_slowed = 0;

  /// Length of a substep [s]; reported forces and impulses are those of the last substep.
  GONOGO_HD Real substep() const { return step / Real(substeps); }

  GONOGO_HD IterationRules rules() const { return {solver, target, iterations, tolerance, substeps}; }
};

/// Bias of a contact [m/s]; the solver keeps the normal speed above its negative. A gap may close in this substep, an
/// overlap opens at a limited speed; a compliant contact gets the resting speed of its spring and damper. `rate`,
/// `softness`: see Contact.
GONOGO_HD inline Real bias_of_gap(Real gap, Real rate, Real softness, const StepSettings& settings) {
  const Real bias = rate * gap;
  if (softness > 0 || gap >= 0) return bias;
  const Real push_out = settings.recovery_share * bias;
  return push_out < -settings.recovery_speed ? -settings.recovery_speed : push_out;
}

struct WorldParameters {
  Vec3 gravity;   // [m/s^2]
  Vec3d origin;   // lower corner of the domain [m]
  Vec3d period;   // length of the domain along x and y where periodic, 0 where open [m]
  Vec3 bin_size;  // [m]
  Index bins[3] = {3, 3, 3};
  Index first_bin = 0;
  BodyIndex first_body = 0;
  Index body_count = 0;
  ShapeIndex first_shape = 0;
  Index shape_count = 0;
  Index first_large = 0, large_count = 0;  // into the list of large shapes, which are not binned
  Index first_motor = 0, motor_count = 0;
  PairLaw law[kMaxMaterials][kMaxMaterials];
};

/// Mass properties; zero means that the motion is prescribed. Separate inverse masses per world axis describe a body on
/// rails: a test-rig wheel carries its whole vehicle along x and only its hub along z.
struct BodyMass {
  Vec3 inverse_mass;           // along world x, y, z [1/kg]
  Vec3 inverse_inertia_B;      // about body axes [1/(kg m^2)]
  std::int32_t isotropic = 1;  // inverse_inertia_B has three equal entries; set by flatten
  std::int32_t slot = -1;      // of its mechanism body, or -1 where nothing is jointed to it; set by flatten
};

GONOGO_HD inline bool is_fixed(const BodyMass& mass) {
  const Vec3 &m = mass.inverse_mass, &i = mass.inverse_inertia_B;
  return m.x == 0 && m.y == 0 && m.z == 0 && i.x == 0 && i.y == 0 && i.z == 0;
}

/// Sums over a world in one step.
struct WorldSums {
  double kinetic = 0;          // [J]
  double gravity_power = 0;    // sum of m g.v [W]
  double residual_square = 0;  // over contacts [m^2/s^2]
  double residual_max = 0;     // [m/s]
  Index contact_count = 0;
  Index iterations = 0;

  GONOGO_HD WorldSums& operator+=(const WorldSums& o) {
    kinetic += o.kinetic;
    gravity_power += o.gravity_power;
    residual_square += o.residual_square;
    residual_max = std::fmax(residual_max, o.residual_max);
    return *this;
  }
};

/// Root-mean-square residual of a step [m/s].
GONOGO_HD inline double rms_residual(const WorldSums& sums) {
  return sums.contact_count > 0 ? std::sqrt(sums.residual_square / sums.contact_count) : 0;
}

/// A binned shape in the order of the bins, so that neighbours are read from consecutive memory.
struct BinnedShape {
  Vec3d centre;  // folded into the period [m]
  Real radius;   // of the sphere around it [m]
  ShapeIndex shape;
};

/// A shape that is not binned, and its bounding box of this step.
struct LargeShape {
  ShapeIndex shape = 0;
  Vec3d middle;  // of the box around it [m]
  Vec3 half;     // half edges of that box along the world's axes [m]
  Vec3 up;       // of a plane: unit normal; what is further above it than its radius is out of reach. Others: zero

  /// Whether a sphere about `d` [m, from the middle] may touch it.
  GONOGO_HD bool reaches(const Vec3& d, Real radius) const {
    return std::fabs(d.z) < half.z + radius && std::fabs(d.x) < half.x + radius && std::fabs(d.y) < half.y + radius &&
           dot(d, up) < radius;
  }
};

inline constexpr int kLargeGroupBits = 3, kLargeGroup = 1 << kLargeGroupBits;
/// Worlds with fewer large shapes test them all.
inline constexpr Index kGroupedFrom = 64;
inline constexpr int kMaxLargeLevels = 11;  // 8^11 exceeds what an Index counts

/// Boxes around groups of large shapes, level after level. Group g of level k holds large shapes 8^(k + 1) g to
/// 8^(k + 1) (g + 1) - 1.
struct LargeGroups {
  View<const LargeShape> box;
  Index first[kMaxLargeLevels + 1] = {};  // [level + 1] in `box`
  int levels = 0;
};

/// Contacts of one step, in the order of the shapes that own them. A step writes one store and reads the other for its
/// warm start.
template <class Exec>
struct ContactStore {
  Buffer<Index, Exec> begin, end;   // [shape] into the arrays below
  Buffer<std::uint64_t, Exec> key;  // [contact] other shape and feature: with the owner, the contact's name
  Buffer<Impulse, Exec> impulse;    // [contact] at the end of the step
};

/// The shapes of a contact.
struct alignas(8) ContactPair {
  ShapeIndex owner, other;
};

struct ContactRange {
  ContactIndex begin, end;
};

/// A run of contacts of one world; see tiles.h.
struct alignas(16) Tile {
  ContactRange contacts;
  WorldIndex world;
  Index first;  // 1: the first of its world
};

/// How far the queued steps came. A step that finds more contacts than the buffers hold does nothing, nor do the steps
/// queued behind it; the host enlarges the buffers and repeats from there.
struct Progress {
  Index halted = 0;         // 1: the buffers hold fewer than contact_total
  Index contact_total = 0;  // found by the latest step
  Index steps = 0;          // completed since the host last looked
};

/// Arrays grouped by who writes them, in the order of a step. In brackets: what an array is indexed by; worlds, bodies
/// and shapes are counted through the batch.
template <class Exec>
struct State {
  // Set by the host when worlds enter the batch.
  Index world_count = 0, body_count = 0, shape_count = 0, bin_count = 0;
  bool solids_binned = false;                               // some binned shape has been no sphere
  bool turning = false;                                     // some law resists rolling or spinning, or is compliant
  Buffer<WorldParameters, Exec> world;                      // [world], also when gravity or a law changes
  Buffer<WorldIndex, Exec> world_of_body;                   // [body]
  Buffer<BodyMass, Exec> mass;                              // [body]
  Buffer<Shape, Exec> shape;                                // [shape], ordered by body
  Buffer<Index, Exec> first_shape;                          // [body + 1]
  Buffer<Index, Exec> first_body_tile, world_of_body_tile;  // [world + 1], [body tile]: runs of kTileSize bodies
  SurfaceStore<Exec> surfaces;

  // Set by the host when it needs more room or has queued a step.
  Index contact_capacity = 0;
  Index parity = 0;  // number of the contact store that the next step writes

  // State of the bodies: set by the host, moved on by solve() and integrate().
  Buffer<Vec3d, Exec> position;     // [body] centres of mass, inside the period [m]
  Buffer<Quat, Exec> orientation;   // [body]
  Buffer<Velocity, Exec> velocity;  // [body]

  // Written by several stages; see the stores.
  MechanismStore<Exec> mechanisms;
  ElementState<Exec> element;
  ContactStore<Exec> store[2];      // by find_contacts(); the impulses by solve()
  Buffer<Progress, Exec> progress;  // one; by find_contacts() and finish_step()

  // Computed by sort_into_bins().
  Buffer<Vec3d, Exec> centre;              // [shape] in the world [m]
  Buffer<Index, Exec> bin_of_shape;        // [shape]; -1: a large one, set by the host
  Buffer<Index, Exec> first_in_bin;        // [bin + 1] into the next two
  Buffer<ShapeIndex, Exec> shape_in_bin;   // by bin
  Buffer<BinnedShape, Exec> shape_by_bin;  // by bin
  Buffer<Index, Exec> bin_cursor;          // [bin] while the bins are filled
  Buffer<LargeShape, Exec> large;          // by world; which shapes: set by the host
  Buffer<LargeShape, Exec> large_group;    // boxes around them, see large.h
  LargeGroups large_groups;                // the same as the search sees them

  // Computed by find_contacts(); see find.h.
  Buffer<Index, Exec> contacts_of_part, first_of_part;  // [shape * kSearchParts]
  Buffer<ShapeIndex, Exec> noted;                       // [shape * kNeighbourRows * kNotedPairs]
  Buffer<ContactPair, Exec> pair;                       // [contact]
  Buffer<Contact, Exec> contact;                        // [contact]; step sizes, biases and gaps also by solve()
  Buffer<Index, Exec> first_contact;                    // [shape + 1]
  Buffer<Index, Exec> contact_weight;                   // [body] see split.h
  Buffer<Index, Exec> second_count;                     // [body] contacts where it is body b and can move

  // Computed by list_contacts(); see incidence.h and tiles.h.
  Buffer<Index, Exec> first_second;                         // [body + 1] into the next two
  Buffer<ContactIndex, Exec> second_found, second_contact;  // in any order; in ascending order
  Buffer<Index, Exec> second_cursor;                        // [body] while the lists are filled
  Buffer<Index, Exec> second_slot;                          // [contact] place in the list of body b, or -1
  Buffer<Index, Exec> tiles_of_world, first_tile;           // [world], [world + 1]
  Buffer<Tile, Exec> tile;

  // Computed by prepare_motion(); apply_force_elements() adds to the change.
  Buffer<SymMat3, Exec> inverse_inertia_W;  // [body], where the moments of inertia differ
  Buffer<Velocity, Exec> velocity_change;   // [body] by gravity, spin and forces in a substep

  // Computed by solve().
  Buffer<Momentum, Exec> momentum;               // [world]
  Buffer<Velocity, Exec> free_velocity;          // [body] without impulses
  Buffer<Velocity, Exec> extrapolated_velocity;  // [body]
  Buffer<Velocity, Exec> substep_velocity;       // [body] of the substep before
  Buffer<Velocity, Exec> earlier_velocity;       // [body] sum over all substeps before the last one
  Buffer<WorldSums, Exec> world_sums;            // [world]

  // Computed by integrate().
  Buffer<Index, Exec> flags;        // [world] StepFlag bits, sticky
  Buffer<PackedFault, Exec> fault;  // [world] the first one
  Buffer<Index, Exec> slowed_now;   // [world] times that a body was slowed in this step

  // Computed by finish_step().
  Buffer<Index, Exec> steps;   // [world] taken so far
  Buffer<Index, Exec> slowed;  // [world] times that a body was slowed so far

  // Memory of scans.
  ScanScratch<Exec> scratch, tile_scratch;
};

/// The number of contacts of this step, which only the execution space knows.
template <class Exec>
Counted contact_count(State<Exec>& s) {
  return {s.contact_capacity, &s.progress.data()->contact_total};
}

}  // namespace gonogo::sim
