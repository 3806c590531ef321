// Arrays of a batch of worlds. A world is a box, periodic along x and y if asked. Its bodies and shapes are contiguous
// and always in the same order, so that its result does not depend on the other worlds of the batch.
#pragma once
#include "base/parallel/for_each.h"
#include "sim/shape/surface_library.h"
#include "sim/state/elements.h"
#include "sim/state/mechanism.h"
#include "sim/state/world.h"

namespace gonogo::sim {

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

/// What a body is to a part of a divided world (simulation/parts). A pair of bodies that are together this strange or
/// more is the business of another part.
enum Strangeness : std::uint8_t { own_body = 0, shared_body = 1, halo_body = 2 };
inline constexpr int kTooStrange = 3;

/// Rows that hold the half of the 27 bins around a shape that it searches.
inline constexpr Index kNeighbourRows = 5;

/// Parts of a shape's contacts: those of two spheres for each row of bins, then all others. Where there are many, a
/// thread of its own counts and writes each part.
inline constexpr Index kSearchParts = kNeighbourRows + 1;

/// Pairs of a part that the count notes, so that they need no second search.
inline constexpr Index kNotedPairs = 3;

/// Name of a contact inside its owner's list, the same in every step.
GONOGO_HD inline std::uint64_t pair_key(ShapeIndex other, int feature) {
  GONOGO_ASSERT(other >= 0 && feature >= 0);
  return (std::uint64_t(std::uint32_t(other)) << 32) | std::uint64_t(std::uint32_t(feature));
}

inline ShapeIndex other_shape(std::uint64_t key) { return ShapeIndex(key >> 32); }

/// The same name after the other shape's index has changed by `shapes`.
inline std::uint64_t shifted_key(std::uint64_t key, ShapeIndex shapes) {
  return pair_key(other_shape(key) + shapes, int(std::uint32_t(key)));
}

/// Contacts of one step, in the order of the shapes that own them. A step writes one store and reads the other for its
/// warm start.
template <class Exec>
struct ContactStore {
  Buffer<Index, Exec> begin, end;        // [shape] into the arrays below
  Buffer<std::uint64_t, Exec> key;       // [contact] other shape and feature: with the owner, the contact's name
  Buffer<Impulse, Exec> impulse;         // [contact] at the end of the step
  Buffer<ContactHistory, Exec> history;  // [contact] of the penalty family; empty for others
};

/// The shapes of a contact.
struct alignas(8) ContactPair {
  ShapeIndex owner, other;
};

struct ContactRange {
  ContactIndex begin, end;
};

/// A run of contacts of one world; see contact_lists.h.
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
  bool turning = false;                                     // some law resists rolling or spinning, or contacts give
  bool remembers = false;                                   // contacts have a history
  Buffer<WorldParameters, Exec> world;                      // [world], also when gravity or a law changes
  Buffer<WorldIndex, Exec> world_of_body;                   // [body]
  Buffer<PenaltyNumbers, Exec> penalty;                     // [world, material, material] where contacts remember
  Buffer<BodyMass, Exec> mass;                              // [body]
  Buffer<Shape, Exec> shape;                                // [shape], ordered by body
  Buffer<Index, Exec> first_shape;                          // [body + 1]
  Buffer<Index, Exec> first_body_tile, world_of_body_tile;  // [world + 1], [body tile]: runs of kTileSize bodies
  SurfaceStore<Exec> surfaces;
  Buffer<std::uint8_t, Exec> strangeness;  // [body] of a part of a world, see Strangeness; else empty

  // Set by the host when it needs more room or has queued a step.
  Index contact_capacity = 0;
  Index parity = 0;         // number of the contact store that the next step writes
  Index partial_tiles = 0;  // max number of tiles that a part of a world has beyond those of a whole one

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
  Buffer<LargeShape, Exec> large_group;    // boxes around them, see bins.h
  LargeGroups large_groups;                // the same as the search sees them

  // Computed by find_contacts(); see find_contacts.h.
  Buffer<Index, Exec> contacts_of_part, first_of_part;  // [shape * kSearchParts]
  Buffer<ShapeIndex, Exec> noted;                       // [shape * kNeighbourRows * kNotedPairs]
  Buffer<ContactPair, Exec> pair;                       // [contact]
  Buffer<Contact, Exec> contact;                        // [contact]; step sizes, biases and gaps also by solve()
  Buffer<Index, Exec> first_contact;                    // [shape + 1]
  Buffer<Index, Exec> contact_weight;                   // [body] see split.h
  Buffer<Index, Exec> second_count;                     // [body] contacts where it is body b and can move

  // Computed by list_contacts(); see contact_lists.h.
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
  GONOGO_ASSERT(s.contact.size() == s.contact_capacity && s.progress.size() == 1);
  return {s.contact_capacity, &s.progress.data()->contact_total};
}

}  // namespace gonogo::sim
