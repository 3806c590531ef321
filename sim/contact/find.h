// Contacts in the order of their owning shape, found twice (to count, then to write) by the same code.
#pragma once
#include "sim/contact/finder.h"

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
  View<const Index> first_contact, old_first_contact;
  View<const std::uint64_t> old_key;
  View<const Impulse> old_impulse;
  View<Contact> contact;
  View<Impulse> impulse;
  View<std::uint64_t> key;

  GONOGO_HD void operator()(Index i) const {
    Index at = first_contact[i];
    find.visit_contacts(i, [&](ShapeIndex j, int feature, const Touch& t, const Vec3d& d) {
      contact[at] = make_contact(i, j, t, d);
      key[at] = pair_key(j, feature);
      impulse[at] = warm_start(i, j, feature, contact[at]);
      ++at;
    });
  }

  /// Speed at which the contact may close (gap ahead) or must open (overlap), negated by the solver's sign convention.
  GONOGO_HD Real bias(Real gap) const {
    if (gap >= 0) return gap / settings.step;
    const Real push_out = settings.recovery_share * gap / settings.step;
    return push_out < -settings.recovery_speed ? -settings.recovery_speed : push_out;
  }

  /// `d`: from the other shape's centre to the owner's.
  GONOGO_HD Contact make_contact(ShapeIndex i, ShapeIndex j, const Touch& t, const Vec3d& d) const {
    const Shape &si = find.shape[i], &sj = find.shape[j];
    const WorldIndex w = find.world_of_body[si.body];
    const PairLaw& law = find.world[w].law[si.material][sj.material];
    const Real smaller = cohesion_radius(si, sj);
    Contact c;
    c.normal = t.normal;
    c.bias = bias(t.gap);
    // The contact point lies half-way between the two surfaces.
    c.arm_a = static_cast<Vec3>(find.centre[i] - position[si.body]) + t.point;
    c.arm_b = static_cast<Vec3>(find.centre[j] - position[sj.body] + d) + t.point;
    c.mu = law.friction;
    c.rho = law.rolling_friction * rolling_radius(si, sj);
    c.cohesion = t.gap < settings.cohesion_range
                     ? law.cohesion_pressure * Real(3.14159265) * smaller * smaller * settings.step
                     : Real(0);
    c.body_a = si.body;
    c.body_b = sj.body;
    c.world = w;
    return c;
  }

  /// Last step's impulse of the same pair, its friction part turned into the new tangent plane. Two spheres in
  /// different bins may have changed owners since: then the other one holds it, with the opposite sign.
  GONOGO_HD Impulse warm_start(ShapeIndex i, ShapeIndex j, int feature, const Contact& c) const {
    if (old_first_contact.size == 0) return {};
    Impulse start;
    if (const ContactIndex own = old_contact(i, pair_key(j, feature)); own >= 0) {
      start = old_impulse[own];
    } else if (const ContactIndex other = old_contact(j, pair_key(i, feature)); other >= 0) {
      start.linear = -old_impulse[other].linear;
      start.angular = -old_impulse[other].angular;
    }
    start.angular -= c.normal * dot(start.angular, c.normal);
    return start;
  }

  GONOGO_HD ContactIndex old_contact(ShapeIndex owner, std::uint64_t name) const {
    for (ContactIndex k = old_first_contact[owner]; k < old_first_contact[owner + 1]; ++k)
      if (old_key[k] == name) return k;
    return -1;
  }
};

template <class Exec>
void find_contacts(Exec exec, State<Exec>& s, const StepSettings& settings) {
  const ContactFinder finder{s.shape.view(), s.centre.view(),       s.orientation.view(),  s.world_of_body.view(),
                             s.world.view(), s.bin_of_shape.view(), s.first_in_bin.view(), s.shape_by_bin.view(),
                             s.large.view(), s.mass.view(),         settings.envelope};
  s.first_contact.swap(s.old_first_contact);
  s.key.swap(s.old_key);
  s.impulse.swap(s.old_impulse);
  s.first_contact.resize(s.shape_count + 1);
  for_each_index(exec, s.shape_count, CountContacts{finder, s.contacts_of_shape.view()});
  s.contact_count = exclusive_scan(exec, s.contacts_of_shape.view(), s.first_contact.view());
  s.contact.resize(s.contact_count);
  s.key.resize(s.contact_count);
  s.impulse.resize(s.contact_count);
  s.extrapolated.resize(s.contact_count);
  s.progress.resize(s.contact_count);
  s.residual_square.resize(s.contact_count);
  for_each_index(
      exec, s.shape_count,
      WriteContacts{finder, settings, s.position.view(), s.first_contact.view(), s.old_first_contact.view(),
                    s.old_key.view(), s.old_impulse.view(), s.contact.view(), s.impulse.view(), s.key.view()});
}

}  // namespace gonogo::sim
