// Narrow phase: the contacts that a shape owns. One shape of every pair, the owner, finds its contacts.
#pragma once
#include "sim/constraint/bins.h"
#include "sim/shape/touch/pairs.h"

namespace gonogo::sim {

struct ContactFinder {
  View<const Shape> shape;
  View<const Vec3d> centre;
  View<const Quat> orientation;
  View<const WorldIndex> world_of_body;
  View<const WorldParameters> world;
  View<const Index> bin_of_shape, first_in_bin;
  View<const BinnedShape> shape_by_bin;
  View<const LargeShape> large;
  LargeGroups large_groups;
  View<const BodyMass> mass;
  View<const MechanismBody> jointed;
  View<const std::uint8_t> strangeness;  // [body], or empty
  SurfaceView surfaces;
  Real envelope;
  bool solids_binned;  // some binned shape is no sphere

  /// Shapes of one group never touch, nor do bodies of one mechanism: hubs sit inside wheels.
  GONOGO_HD bool may_touch(ShapeIndex i, ShapeIndex j) const {
    const Shape &a = shape[i], &b = shape[j];
    if (a.body == b.body || (a.group != 0 && a.group == b.group)) return false;
    if (is_fixed(mass[a.body]) && is_fixed(mass[b.body])) return false;
    if (strangeness.size > 0 && strangeness[a.body] + strangeness[b.body] >= kTooStrange) return false;
    const Index slot_a = mass[a.body].slot, slot_b = mass[b.body].slot;
    return slot_a < 0 || slot_b < 0 || jointed[slot_a].mechanism != jointed[slot_b].mechanism;
  }

  /// Calls visit(other shape, feature, touch, d) for the contacts that shape `i` owns with other spheres in one row of
  /// bins; d: from the other shape's centre to that of `i`.
  template <class Visit>
  GONOGO_HD void visit_spheres(ShapeIndex i, Index row, Visit&& visit) const {
    if (bin_of_shape[i] < 0 || shape[i].type != ShapeType::sphere) return;
    visit_binned(i, row, [&](const BinnedShape& other, const Vec3d& apart) {
      if (shape[other.shape].type != ShapeType::sphere) return;
      visit(other.shape, 0, sphere_touch(i, other.shape, static_cast<Vec3>(apart)), apart);
    });
  }

  GONOGO_HD Touch sphere_touch(ShapeIndex i, ShapeIndex j, const Vec3& d) const {
    GONOGO_ASSERT(shape[i].type == ShapeType::sphere && shape[j].type == ShapeType::sphere);
    const Real radius = shape[i].size.x;
    const Gap g = sphere_sphere_gap(d, radius + shape[j].size.x);
    return {g.gap, g.normal, g.normal * -(radius + g.gap / 2)};
  }

  GONOGO_HD static Vec3d folded_centre(const Vec3d& c, const WorldParameters& w) {
    return {folded(c.x, w.origin.x, w.period.x), folded(c.y, w.origin.y, w.period.y), c.z};
  }

  /// From the centre of j to that of i, both binned, with the bits of the search.
  GONOGO_HD Vec3d between_binned(ShapeIndex i, ShapeIndex j) const {
    const WorldParameters& w = world[world_of_body[shape[i].body]];
    return nearest_image(folded_centre(centre[i], w) - folded_centre(centre[j], w), w.period);
  }

  /// Calls visit for all other contacts. Apart from the spheres, because its code needs more registers.
  template <class Visit>
  GONOGO_HD void visit_others(ShapeIndex i, Visit&& visit) const {
    const Shape& own = shape[i];
    if (own.type == ShapeType::none) return;
    if (solids_binned && bin_of_shape[i] >= 0)
      for (Index row = 0; row < kNeighbourRows; ++row)
        visit_binned(i, row, [&](const BinnedShape& other, const Vec3d& apart) {
          if (own.type != ShapeType::sphere || shape[other.shape].type != ShapeType::sphere)
            visit_pair(i, other.shape, apart, visit);
        });
    const WorldParameters& w = world[world_of_body[own.body]];
    const Real reach = (bounding_radius(own) + envelope) * Real(BoundLargeGroup::kRoomy);
    visit_large_near(
        large_groups, w.first_large, w.first_large + w.large_count,
        [&](const LargeShape& box) {
          return box.reaches(static_cast<Vec3>(nearest_image(centre[i] - box.middle, w.period)), reach);
        },
        [&](Index l) { visit_large(i, large[l], w, visit); });
  }

  /// Calls near(other, d) for the binned shapes of a row of bins that may touch shape `i`.
  template <class Near>
  GONOGO_HD void visit_binned(ShapeIndex i, Index row, Near&& near) const {
    const WorldParameters& w = world[world_of_body[shape[i].body]];
    const Vec3d here = folded_centre(centre[i], w);
    const Real reach_i = bounding_radius(shape[i]) + envelope;
    visit_neighbour_row(w, bin_of(w, here), row, [&](Index first, Index last, bool shared) {
      const Index own_end = first_in_bin[first + 1];
      for (Index k = first_in_bin[first]; k < first_in_bin[last]; ++k) {
        const BinnedShape& other = shape_by_bin[k];
        if (shared && k < own_end && other.shape <= i) continue;
        const Vec3d apart = nearest_image(here - other.centre, w.period);
        const auto d = static_cast<Vec3>(apart);
        const Real reach = reach_i + other.radius;
        if (dot(d, d) < reach * reach && may_touch(i, other.shape)) near(other, apart);
      }
    });
  }

  /// Whether i owns its contacts with the large shape j: i is binned, or it alone moves, or it comes first.
  GONOGO_HD bool owns(ShapeIndex i, ShapeIndex j) const {
    if (bin_of_shape[i] >= 0) return true;
    const bool moves_i = !is_fixed(mass[shape[i].body]), moves_j = !is_fixed(mass[shape[j].body]);
    return moves_i != moves_j ? moves_i : i < j;
  }

  template <class Visit>
  GONOGO_HD void visit_large(ShapeIndex i, const LargeShape& other, const WorldParameters& w, Visit&& visit) const {
    const Vec3d from_middle = nearest_image(centre[i] - other.middle, w.period);
    if (!other.reaches(static_cast<Vec3>(from_middle), bounding_radius(shape[i]) + envelope) ||
        !may_touch(i, other.shape) || !owns(i, other.shape))
      return;
    visit_pair(i, other.shape, from_middle + (other.middle - centre[other.shape]), visit);
  }

  template <class Visit>
  GONOGO_HD void visit_pair(ShapeIndex i, ShapeIndex j, const Vec3d& d, Visit&& visit) const {
    const Shape &own = shape[i], &other = shape[j];
    GONOGO_ASSERT(i != j && own.body != other.body && have_routine(own.type, other.type));
    const Quat qi = shape_orientation(own, orientation[own.body]);
    const Quat qj = shape_orientation(other, orientation[other.body]);
    const bool first = own.type < other.type || (own.type == other.type && i < j);
    const ShapePair pair{.a = first ? own : other,
                         .b = first ? other : own,
                         .qa = first ? qi : qj,
                         .qb = first ? qj : qi,
                         .d = first ? d : -d,
                         .envelope = envelope,
                         .surfaces = surfaces};
    visit_touches(pair, [&](int feature, const Touch& t) { visit(j, feature, first ? t : seen_from_other(t, -d), d); });
  }
};

}  // namespace gonogo::sim
