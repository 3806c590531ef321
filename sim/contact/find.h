// Contacts in the order of their owning shape, found twice (to count, then to write) by the same code.
#pragma once
#include "sim/contact/finder.h"
#include "sim/solver/tiles.h"

namespace gonogo::sim {

struct CountContacts {
  ContactFinder find;
  View<Index> contacts_of_shape;

  GONOGO_HD void operator()(Index i) const {
    Index count = 0;
    find.visit_contacts(i, [&](ShapeIndex, int, const Touch&, const Vec3d&) { ++count; });
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
    find.visit_contacts(i, [&](ShapeIndex j, int feature, const Touch& t, const Vec3d& d) {
      contact[at] = make_contact(i, j, t, d);
      key[at] = pair_key(j, feature);
      impulse[at] = warm_start(i, j, feature);
      ++at;
    });
  }

  /// A compliant contact is a spring and damper along the normal, implicit in the gap's rate u:
  ///   impulse = -h (k (gap + h u) + c u)   <=>   u + impulse / (h (h k + c)) + k gap / (h k + c) = 0.
  GONOGO_HD void set_stiffness(Contact& c, const PairLaw& law) const {
    const Real step = settings.substep();
    c.gap_rate = 1 / step;
    c.softness = 0;
    if (law.stiffness > 0) {
      const Real resistance = step * law.stiffness + law.damping;  // [N s/m]
      c.gap_rate = law.stiffness / resistance;
      c.softness = 1 / (step * resistance);
    }
    c.gap_bias = bias_of_gap(c, settings);
  }

  /// `d`: from the other shape's centre to the owner's.
  GONOGO_HD Contact make_contact(ShapeIndex i, ShapeIndex j, const Touch& t, const Vec3d& d) const {
    const Shape &si = find.shape[i], &sj = find.shape[j];
    const WorldIndex w = find.world_of_body[si.body];
    const PairLaw& law = find.world[w].law[si.material][sj.material];
    const Real radius = rolling_radius(si, sj), smaller = cohesion_radius(si, sj);
    Contact c;
    c.normal = t.normal;
    c.gap = t.gap;
    set_stiffness(c, law);
    // The contact point lies half-way between the two surfaces.
    c.arm_a = static_cast<Vec3>(find.centre[i] - position[si.body]) + t.point;
    c.arm_b = static_cast<Vec3>(find.centre[j] - position[sj.body] + d) + t.point;
    c.mu = law.friction;
    c.rho = law.rolling_friction * radius;
    c.sigma = law.spinning_friction * radius;
    c.cohesion = t.gap < settings.cohesion_range
                     ? law.cohesion_pressure * Real(3.14159265) * smaller * smaller * settings.substep()
                     : Real(0);
    c.body_a = si.body;
    c.body_b = sj.body;
    c.world = w;
    return c;
  }

  /// Last step's impulse of the same contact. Two shapes in different bins may have changed owners since: then the
  /// other one holds it, with the opposite sign.
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
ContactFinder contact_finder(State<Exec>& s, const StepSettings& settings) {
  return {s.shape.view(),   s.centre.view(),       s.orientation.view(),     s.world_of_body.view(),
          s.world.view(),   s.bin_of_shape.view(), s.first_in_bin.view(),    s.shape_by_bin.view(),
          s.large.view(),   s.mass.view(),         s.mechanisms.body.view(), s.surfaces.view(),
          settings.envelope};
}

template <class Exec>
void find_contacts(Exec exec, State<Exec>& s, const StepSettings& settings) {
  const ContactFinder finder = contact_finder(s, settings);
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
