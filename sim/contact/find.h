// Narrow phase: contacts in the order of their owning sphere, found twice (to count, then to write) by the same code.
#pragma once
#include "sim/broad_phase/bins.h"
#include "sim/shape/gap.h"
#include "sim/solver/tiles.h"

namespace gonogo::sim {

/// Order of the pair inside the owner's list and its name across steps.
GONOGO_HD inline std::uint64_t pair_key(ShapeIndex other, int feature) {
  return (std::uint64_t(std::uint32_t(other)) << 16) | std::uint64_t(std::uint16_t(feature));
}

/// The same name when the other shape's index changes by `shapes`.
inline std::uint64_t shifted_key(std::uint64_t key, ShapeIndex shapes) {
  return pair_key(ShapeIndex(key >> 16) + shapes, int(key & 0xFFFF));
}

struct ContactFinder {
  View<const Shape> shape;
  View<const Vec3d> centre;
  View<const Quat> orientation;
  View<const WorldIndex> world_of_body;
  View<const WorldParameters> world;
  View<const Index> bin_of_shape, first_in_bin;
  View<const BinnedSphere> sphere_in_bin;
  View<const ShapeIndex> large;
  View<const BodyMass> mass;
  View<const MechanismBody> jointed;
  Real envelope;

  /// Bodies of one mechanism pass through each other: hubs sit inside wheels.
  GONOGO_HD bool may_touch(ShapeIndex i, ShapeIndex j) const {
    const BodyIndex a = shape[i].body, b = shape[j].body;
    if (a == b || (is_fixed(mass[a]) && is_fixed(mass[b]))) return false;
    const Index slot_a = mass[a].slot, slot_b = mass[b].slot;
    return slot_a < 0 || slot_b < 0 || jointed[slot_a].mechanism != jointed[slot_b].mechanism;
  }

  /// Calls visit(other shape, feature, gap) for every contact that sphere `i` owns.
  template <class Visit>
  GONOGO_HD void visit_contacts(ShapeIndex i, Visit&& visit) const {
    const WorldParameters& w = world[world_of_body[shape[i].body]];
    if (shape[i].type == ShapeType::sphere) {
      if (bin_of_shape[i] >= 0) visit_spheres(i, w, visit);
      for (Index l = w.first_large; l < w.first_large + w.large_count; ++l) visit_large(i, large[l], w, visit);
    } else if (shape[i].type == ShapeType::box) {
      for (Index l = w.first_large; l < w.first_large + w.large_count; ++l)
        if (shape[large[l]].type == ShapeType::plane && may_touch(i, large[l])) visit_box_plane(i, large[l], visit);
    }
  }

  template <class Visit>
  GONOGO_HD void visit_spheres(ShapeIndex i, const WorldParameters& w, Visit&& visit) const {
    const Vec3d here{folded(centre[i].x, w.origin.x, w.period.x), folded(centre[i].y, w.origin.y, w.period.y),
                     centre[i].z};
    const Real radius = shape[i].size.x, reach_i = radius + envelope;
    visit_neighbour_bins(w, bin_of(w, here), [&](Index first, Index last, bool shared) {
      const Index own_end = first_in_bin[first + 1];
      for (Index k = first_in_bin[first]; k < first_in_bin[last]; ++k) {
        const BinnedSphere& other = sphere_in_bin[k];
        if (shared && k < own_end && other.shape <= i) continue;
        const auto d = static_cast<Vec3>(nearest_image(here - other.centre, w.period));
        const Real reach = reach_i + other.radius;
        if (dot(d, d) < reach * reach && may_touch(i, other.shape))
          visit(other.shape, 0, sphere_sphere_gap(d, radius + other.radius));
      }
    });
  }

  template <class Visit>
  GONOGO_HD void visit_sphere_pair(ShapeIndex i, ShapeIndex j, const WorldParameters& w, Visit&& visit) const {
    const auto d = static_cast<Vec3>(nearest_image(centre[i] - centre[j], w.period));
    const Real reach = shape[i].size.x + shape[j].size.x + envelope;
    if (dot(d, d) >= reach * reach || !may_touch(i, j)) return;
    visit(j, 0, sphere_sphere_gap(d, shape[i].size.x + shape[j].size.x));
  }

  template <class Visit>
  GONOGO_HD void visit_large(ShapeIndex i, ShapeIndex j, const WorldParameters& w, Visit&& visit) const {
    const Shape& other = shape[j];
    if (other.type == ShapeType::sphere) {  // large spheres meet each other once
      if (bin_of_shape[i] >= 0 || i < j) visit_sphere_pair(i, j, w, visit);
      return;
    }
    const Real radius = shape[i].size.x;
    const Quat& q = orientation[other.body];
    const auto d = static_cast<Vec3>(nearest_image(centre[i] - centre[j], w.period));
    if (other.type == ShapeType::plane) {
      const Vec3 normal = rotate(q, {0, 0, 1});
      const Real gap = dot(d, normal) - radius;
      if (gap < envelope && may_touch(i, j)) visit(j, 0, Gap{gap, normal});
      return;
    }
    // Boxes and wheels: reject by a bounding sphere before turning into their frame.
    const Real edge = lug_edge_radius(other);
    const Real reach =
        radius + envelope +
        (other.type == ShapeType::box ? length(other.size) : std::sqrt(edge * edge + other.size.y * other.size.y));
    if (dot(d, d) >= reach * reach || !may_touch(i, j)) return;
    const Vec3 p = rotate_back(q, d);
    if (other.type == ShapeType::box) {
      const Gap g = sphere_box_gap(p, other.size, radius);
      if (g.gap < envelope) visit(j, 0, Gap{g.gap, rotate(q, g.normal)});
    } else {
      visit_wheel_gaps(p, other, radius, envelope, [&](int feature, const Gap& g) {
        visit(j, feature, Gap{g.gap, rotate(q, g.normal)});
      });
    }
  }

  /// The eight corners of a box against a plane; feature: corner.
  template <class Visit>
  GONOGO_HD void visit_box_plane(ShapeIndex i, ShapeIndex j, Visit&& visit) const {
    const Vec3 normal = rotate(orientation[shape[j].body], {0, 0, 1});
    const auto d = static_cast<Vec3>(centre[i] - centre[j]);
    for (int corner = 0; corner < 8; ++corner) {
      const Real gap = dot(d + box_corner(i, corner), normal);
      if (gap < envelope) visit(j, corner, Gap{gap, normal});
    }
  }

  /// From the box's centre to one of its corners, in the world.
  GONOGO_HD Vec3 box_corner(ShapeIndex i, int corner) const {
    const Vec3& h = shape[i].size;
    return rotate(orientation[shape[i].body],
                  {corner & 1 ? h.x : -h.x, corner & 2 ? h.y : -h.y, corner & 4 ? h.z : -h.z});
  }
};

struct CountContacts {
  ContactFinder find;
  View<Index> contacts_of_shape;

  GONOGO_HD void operator()(Index i) const {
    Index count = 0;
    find.visit_contacts(i, [&](ShapeIndex, int, const Gap&) { ++count; });
    contacts_of_shape[i] = count;
  }
};

struct WriteContacts {
  ContactFinder find;
  StepSettings settings;
  View<const Vec3d> position;
  View<const Index> first_contact, old_begin, old_end;  // [shape + 1], [shape], [shape]
  View<const std::uint64_t> old_key;
  View<const Impulse> old_impulse;
  View<Contact> contact;
  View<Impulse> impulse;
  View<std::uint64_t> key;
  View<Index> begin, end;  // [shape]

  GONOGO_HD void operator()(Index i) const {
    Index at = first_contact[i];
    begin[i] = at;
    end[i] = first_contact[i + 1];
    find.visit_contacts(i, [&](ShapeIndex j, int feature, const Gap& g) {
      contact[at] = make_contact(i, j, feature, g);
      key[at] = pair_key(j, feature);
      impulse[at] = warm_start(i, j, feature);
      ++at;
    });
  }

  /// Speed at which the contact may close (gap ahead) or must open (overlap), negated by the solver's sign convention.
  GONOGO_HD Real bias(Real gap) const {
    if (gap >= 0) return gap / settings.step;
    const Real push_out = settings.recovery_share * gap / settings.step;
    return push_out < -settings.recovery_speed ? -settings.recovery_speed : push_out;
  }

  /// A compliant contact is a spring and damper along the normal, implicit in the gap's rate u:
  ///   impulse = -h (k (gap + h u) + c u)   <=>   u + impulse / (h (h k + c)) + k gap / (h k + c) = 0.
  GONOGO_HD void set_stiffness(Contact& c, const PairLaw& law, Real gap) const {
    if (law.stiffness <= 0) {
      c.gap_bias = bias(gap);
      c.softness = 0;
      return;
    }
    const Real resistance = settings.step * law.stiffness + law.damping;  // [N s/m]
    c.gap_bias = law.stiffness * gap / resistance;
    c.softness = 1 / (settings.step * resistance);
  }

  GONOGO_HD Contact make_contact(ShapeIndex i, ShapeIndex j, int feature, const Gap& g) const {
    const Shape &si = find.shape[i], &sj = find.shape[j];
    const WorldIndex w = find.world_of_body[si.body];
    const WorldParameters& world = find.world[w];
    const PairLaw& law = world.law[si.material][sj.material];
    const bool other_is_sphere = sj.type == ShapeType::sphere;
    const Real radius = si.type != ShapeType::sphere ? 0
                        : other_is_sphere            ? si.size.x * sj.size.x / (si.size.x + sj.size.x)
                                                     : si.size.x;
    const Real smaller = other_is_sphere ? std::fmin(si.size.x, sj.size.x) : si.size.x;
    Contact c;
    c.normal = g.normal;
    c.gap = g.gap;
    set_stiffness(c, law, g.gap);
    // The contact point lies half-way between the two surfaces.
    const auto from_a_centre =
        si.type == ShapeType::box ? find.box_corner(i, feature) : g.normal * -(si.size.x + g.gap / 2);
    const auto a_to_centre = static_cast<Vec3>(find.centre[i] - position[si.body]);
    c.arm_a = a_to_centre + from_a_centre;
    c.arm_b = static_cast<Vec3>(nearest_image(find.centre[i] - position[sj.body], world.period)) + from_a_centre;
    c.mu = law.friction;
    c.rho = law.rolling_friction * radius;
    c.sigma = law.spinning_friction * radius;
    c.cohesion = g.gap < settings.cohesion_range
                     ? law.cohesion_pressure * Real(3.14159265) * smaller * smaller * settings.step
                     : Real(0);
    c.body_a = si.body;
    c.body_b = sj.body;
    c.world = w;
    return c;
  }

  /// Last step's impulse of the same pair. Two spheres in
  /// different bins may have changed owners since: then the other one holds it, with the opposite sign.
  GONOGO_HD Impulse warm_start(ShapeIndex i, ShapeIndex j, int feature) const {
    Impulse start;
    if (const ContactIndex own = old_contact(i, pair_key(j, feature)); own >= 0) {
      start = old_impulse[own];
    } else if (const ContactIndex other = old_contact(j, pair_key(i, feature)); other >= 0) {
      start.linear = -old_impulse[other].linear;
      start.angular = -old_impulse[other].angular;
    }
    return start;
  }

  GONOGO_HD ContactIndex old_contact(ShapeIndex owner, std::uint64_t name) const {
    for (ContactIndex k = old_begin[owner]; k < old_end[owner]; ++k)
      if (old_key[k] == name) return k;
    return -1;
  }
};

/// Makes room for the contacts just counted. On the host at once; on the device the step is given up and the buffers
/// are enlarged before it is taken again (see Progress).
struct CheckCapacity {
  View<const Index> first_contact;
  View<Progress> progress;
  Index capacity;
  GONOGO_HD void operator()(Index) const {
    progress[0].contact_total = first_contact[first_contact.size - 1];
    if (progress[0].contact_total > capacity) progress[0].halted = 1;
  }
};

template <class Exec>
void reserve_contacts(State<Exec>& s, Index count) {
  s.contact_capacity = count;
  s.contact.resize(count);
  s.second_found.resize(count);
  s.second_contact.resize(count);
  s.second_slot.resize(count);
  s.tile.resize(tile_capacity(s));
  for (ContactStore<Exec>& store : s.store) {
    store.key.resize(count);
    store.impulse.resize(count);
  }
}

template <class Exec>
void find_contacts(Exec exec, State<Exec>& s, const StepSettings& settings) {
  const ContactFinder finder{s.shape.view(), s.centre.view(),       s.orientation.view(),  s.world_of_body.view(),
                             s.world.view(), s.bin_of_shape.view(), s.first_in_bin.view(), s.sphere_in_bin.view(),
                             s.large.view(), s.mass.view(), s.mechanisms.body.view(), settings.envelope};
  for_each_index(exec, s.shape_count, CountContacts{finder, s.contacts_of_shape.view()});
  exclusive_scan(exec, s.contacts_of_shape.view(), s.first_contact.view(), s.scratch);
  for_each_index(exec, 1, CheckCapacity{s.first_contact.view(), s.progress.view(), s.contact_capacity});
  make_room_for_contacts(exec, s);
  ContactStore<Exec>&now = s.store[s.parity], &old = s.store[1 - s.parity];
  for_each_index(exec, s.shape_count,
                 WriteContacts{finder, settings, s.position.view(), s.first_contact.view(), old.begin.view(),
                               old.end.view(), old.key.view(), old.impulse.view(), s.contact.view(), now.impulse.view(),
                               now.key.view(), now.begin.view(), now.end.view()});
}

}  // namespace gonogo::sim
