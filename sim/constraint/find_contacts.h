// The search for contacts: counts those of each owning shape, then writes them in that order. The count notes most
// pairs of spheres; the same code finds the others a second time.
#pragma once
#include <limits>

#include "base/host_device.h"
#include "base/parallel/for_each.h"
#include "base/units.h"
#include "sim/constraint/contact_finder.h"
#include "sim/state/contact_lists.h"

namespace gonogo::sim {

/// Rows that one thread searches. More threads hide the latency of memory, but with many shapes they only repeat work.
inline constexpr Index rows_per_thread(Cpu, Index) { return kNeighbourRows; }
inline constexpr Index rows_per_thread(Cuda, Index shapes) { return shapes < 100'000 ? 1 : kNeighbourRows; }

/// Calls work(shape, row) for the rows of thread `t`; neighbouring threads have neighbouring shapes.
template <class Work>
GONOGO_HD inline void visit_rows(Index t, Index shapes, Index rows, Work&& work) {
  GONOGO_ASSERT(shapes > 0 && t / shapes * rows + rows <= kNeighbourRows);
  const Index first = t / shapes * rows;
  for (Index row = first; row < first + rows; ++row) work(t % shapes, row);
}

struct CountSphereContacts {
  ContactFinder find;
  View<Index> contacts_of_part;  // [shape * kSearchParts + part]
  View<ShapeIndex> noted;        // [(shape * kNeighbourRows + row) * kNotedPairs] other shapes
  Index rows;                    // per thread

  GONOGO_HD void operator()(Index t) const {
    visit_rows(t, find.shape.size, rows, [&](ShapeIndex i, Index row) {
      Index count = 0;
      ShapeIndex* const note = &noted[(i * kNeighbourRows + row) * kNotedPairs];
      find.visit_spheres(i, row, [&](ShapeIndex j, int, const Touch&, const Vec3d&) {
        if (count < kNotedPairs) note[count] = j;
        ++count;
      });
      contacts_of_part[i * kSearchParts + row] = count;
    });
  }
};

struct CountOtherContacts {
  ContactFinder find;
  View<Index> contacts_of_part;

  GONOGO_HD void operator()(ShapeIndex i) const {
    Index count = 0;
    find.visit_others(i, [&](ShapeIndex, int, const Touch&, const Vec3d&) { ++count; });
    contacts_of_part[i * kSearchParts + kNeighbourRows] = count;
  }
};

/// Writes a contact, with its warm start, and adds it to the sums of its bodies.
struct ContactWriter {
  ContactFinder find;
  StepSettings settings;
  View<const Vec3d> position;
  View<const Index> first_of_part;       // [shape * kSearchParts + part], and the total
  View<const Index> old_begin, old_end;  // [shape]
  View<const std::uint64_t> old_key;
  View<const Impulse> old_impulse;
  View<Contact> contact;
  View<Impulse> impulse;
  View<std::uint64_t> key;
  View<Index> contact_weight_of_body, second_count;  // [body] sums, for the solver

  GONOGO_HD void write(ContactIndex at, ShapeIndex i, ShapeIndex j, int feature, const Touch& t, const Vec3d& d) const {
    GONOGO_ASSERT(is_unit(t.normal) && !(t.gap > settings.envelope + rounding_of_gap(i, j)));
    Contact c = make_contact(i, j, feature, t, d);
    const Impulse start = warm_start(i, j, feature);
    c.gap = counted_gap(c.gap, c.gap_rate, c.softness * dot(start.linear, c.normal), settings);
    c.gap_bias = bias_of_gap(c.gap, c.gap_rate, c.softness, settings);
    store_words(contact[at], c);
    key[at] = pair_key(j, feature);
    impulse[at] = start;
    count(c, start);
  }

  /// The search compares squares of distances, so that the gap of two spheres may exceed the envelope by its rounding.
  GONOGO_HD Real rounding_of_gap(ShapeIndex i, ShapeIndex j) const {
    return Real(1e-6) * (bounding_radius(find.shape[i]) + bounding_radius(find.shape[j]));
  }

  /// Fixed bodies get no list of contacts: they do not move, and a floor under a bed would have thousands.
  GONOGO_HD void count(const Contact& c, const Impulse& start) const {
    GONOGO_ASSERT(c.body_a != c.body_b && !(is_fixed(find.mass[c.body_a]) && is_fixed(find.mass[c.body_b])));
    const Index own = contact_weight(c, start);
    if (!is_fixed(find.mass[c.body_a])) atomic_add(contact_weight_of_body[c.body_a], own);
    if (is_fixed(find.mass[c.body_b])) return;
    atomic_add(contact_weight_of_body[c.body_b], own);
    atomic_add(second_count[c.body_b], 1);
  }

  /// A compliant contact is a spring and damper along the normal, implicit in the gap's rate u:
  ///   impulse = -h (k (gap + h u) + c u)   <=>   u + impulse / (h (h k + c)) + k gap / (h k + c) = 0.
  /// A contact whose law is rigid may have numerical give, see counted_gap.
  GONOGO_HD void set_stiffness(Contact& c, const PairLaw& law) const {
    const Real step = settings.substep();
    c.gap_rate = 1 / step;
    c.softness = 0;
    if (law.stiffness > 0) {
      const Real resistance = step * law.stiffness + law.damping;  // [N s/m]
      c.gap_rate = law.stiffness / resistance;
      c.softness = 1 / (step * resistance);
    } else if (settings.give > 0) {
      c.gap_rate = settings.give_rate();
      c.softness = settings.give * (mobility(find.mass[c.body_a], c.arm_a, c.normal) +
                                    mobility(find.mass[c.body_b], c.arm_b, c.normal));
    }
  }

  /// `d`: from the other shape's centre to the owner's. A grain rolls freely on a lug, which is thin and so has little
  /// but edges: its effective radius with an edge is 0.
  GONOGO_HD_INLINED Contact make_contact(ShapeIndex i, ShapeIndex j, int feature, const Touch& t,
                                         const Vec3d& d) const {
    const Shape &si = find.shape[i], &sj = find.shape[j];
    GONOGO_ASSERT(is_material(si.material) && is_material(sj.material));
    const WorldIndex w = find.world_of_body[si.body];
    GONOGO_ASSERT(w == find.world_of_body[sj.body]);
    const PairLaw& law = find.world[w].law[si.material][sj.material];
    const Real radius = is_on_lug(si, sj, feature) ? Real(0) : rolling_radius(si, sj);
    const Real smaller = cohesion_radius(si, sj);
    Contact c;
    c.normal = t.normal;
    c.gap = t.gap;
    // The contact point is midway between the two surfaces.
    c.arm_a = static_cast<Vec3>(find.centre[i] - position[si.body]) + t.point;
    c.arm_b = static_cast<Vec3>(find.centre[j] - position[sj.body] + d) + t.point;
    c.mu = law.friction;
    c.rho = law.rolling_friction * radius;
    c.sigma = law.spinning_friction * radius;
    c.cohesion = t.gap < settings.cohesion_range
                     ? law.cohesion_pressure * Real(kPi) * smaller * smaller * settings.substep()
                     : Real(0);
    c.body_a = si.body;
    c.body_b = sj.body;
    c.world = w;
    set_stiffness(c, law);
    return c;
  }

  /// Last step's impulse of the same contact. The other shape may have owned it then; its impulse has the opposite
  /// sign.
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

/// Names the pairs of spheres; WriteSphereContact then writes each contact by a thread of its own.
struct ListSpherePairs {
  ContactFinder find;
  View<const Index> first_of_part;
  View<const ShapeIndex> noted;  // see CountSphereContacts
  View<ContactPair> pair;
  Index rows;  // per thread

  GONOGO_HD void operator()(Index t) const {
    visit_rows(t, find.shape.size, rows, [&](ShapeIndex i, Index row) {
      Index at = first_of_part[i * kSearchParts + row];
      const Index end = first_of_part[i * kSearchParts + row + 1];
      if (end - at <= kNotedPairs) {
        for (Index n = (i * kNeighbourRows + row) * kNotedPairs; at < end; ++at, ++n) pair[at] = {i, noted[n]};
        return;
      }
      find.visit_spheres(i, row, [&](ShapeIndex j, int, const Touch&, const Vec3d&) { pair[at++] = {i, j}; });
      GONOGO_ASSERT(at == end);  // found again what the count found
    });
  }
};

/// Writes the contacts that are not of two spheres, and each shape's range of contacts.
struct WriteOtherContacts {
  ContactWriter writer;
  View<ContactPair> pair;
  View<Index> first_contact, begin, end;  // [shape + 1], [shape]

  GONOGO_HD void operator()(ShapeIndex i) const {
    first_contact[i] = begin[i] = writer.first_of_part[i * kSearchParts];
    end[i] = writer.first_of_part[(i + 1) * kSearchParts];
    if (i + 1 == begin.size) first_contact[i + 1] = end[i];
    Index at = writer.first_of_part[i * kSearchParts + kNeighbourRows];
    writer.find.visit_others(i, [&](ShapeIndex j, int feature, const Touch& t, const Vec3d& d) {
      pair[at] = {i, j};
      writer.write(at++, i, j, feature, t, d);
    });
    GONOGO_ASSERT(at == end[i]);
  }
};

struct WriteSphereContact {
  ContactWriter writer;
  View<const ContactPair> pair;

  GONOGO_HD void operator()(ContactIndex at) const {
    const ShapeIndex i = pair[at].owner, j = pair[at].other;
    GONOGO_ASSERT(at >= writer.first_of_part[i * kSearchParts] && at < writer.first_of_part[(i + 1) * kSearchParts]);
    if (at >= writer.first_of_part[i * kSearchParts + kNeighbourRows]) return;  // not of two spheres
    const Vec3d apart = writer.find.between_binned(i, j);
    writer.write(at, i, j, 0, writer.find.sphere_touch(i, j, static_cast<Vec3>(apart)), apart);
  }
};

/// Halts the step when the contacts just counted exceed the buffers, see Progress.
struct CheckCapacity {
  View<const Index> first_of_part;
  View<Progress> progress;
  Index capacity;
  GONOGO_HD void operator()(Index) const {
    progress[0].contact_total = first_of_part[first_of_part.size - 1];
    if (progress[0].contact_total > capacity) progress[0].halted = 1;
  }
};

/// Bodies see two halves of every contact, counted by one Index.
inline constexpr Index kMaxContacts = std::numeric_limits<Index>::max() / 2;

/// New capacity when `found` contacts exceed the old one: half as many more. Throws InputError beyond kMaxContacts.
inline Index roomier(Index found) {
  if (found < 0 || found > kMaxContacts)
    throw InputError("the worlds have more than " + std::to_string(kMaxContacts) +
                     " contacts; use fewer or smaller worlds, or a smaller envelope");
  return Index(std::min<std::int64_t>(std::int64_t(found) + found / 2, kMaxContacts));
}

template <class Exec>
void reserve_contacts(State<Exec>& s, Index count) {
  GONOGO_ASSERT(count > 0 && count <= kMaxContacts);
  s.contact_capacity = count;
  s.contact.resize(count);
  s.pair.resize(count);
  s.second_found.resize(count);
  s.second_contact.resize(count);
  s.second_slot.resize(count);
  s.tile.resize(tile_capacity(s));
  for (ContactStore<Exec>& store : s.store) {
    store.key.resize(count);
    store.impulse.resize(count);
    if (s.remembers) store.history.resize(count);
  }
}

/// On the host the buffers grow within the step that needs them.
inline void make_room_for_contacts(Cpu, State<Cpu>& s) {
  Progress progress = s.progress.read(0);
  if (progress.halted == 0) return;
  reserve_contacts(s, progress.contact_total + progress.contact_total / 2);
  progress.halted = 0;
  s.progress.write(0, progress);
}

/// On the GPU the step is abandoned; the host enlarges the buffers and repeats it, see Progress.
inline void make_room_for_contacts(Cuda, State<Cuda>&) {}

template <class Exec>
ContactFinder contact_finder(State<Exec>& s, const StepSettings& settings) {
  return {.shape = s.shape.view(),
          .centre = s.centre.view(),
          .orientation = s.orientation.view(),
          .world_of_body = s.world_of_body.view(),
          .world = s.world.view(),
          .bin_of_shape = s.bin_of_shape.view(),
          .first_in_bin = s.first_in_bin.view(),
          .shape_by_bin = s.shape_by_bin.view(),
          .large = s.large.view(),
          .large_groups = s.large_groups,
          .mass = s.mass.view(),
          .jointed = s.mechanisms.body.view(),
          .strangeness = s.strangeness.view(),
          .surfaces = s.surfaces.view(),
          .envelope = settings.envelope,
          .solids_binned = s.solids_binned};
}

/// Reads warm starts from the store of the step before.
template <class Exec>
ContactWriter contact_writer(State<Exec>& s, const ContactFinder& finder, const StepSettings& settings) {
  ContactStore<Exec>&now = s.store[s.parity], &old = s.store[1 - s.parity];
  return {.find = finder,
          .settings = settings,
          .position = s.position.view(),
          .first_of_part = s.first_of_part.view(),
          .old_begin = old.begin.view(),
          // Contacts that remember look their old names up themselves, see PushContact; they have no warm start.
          .old_end = s.remembers ? old.begin.view() : old.end.view(),
          .old_key = old.key.view(),
          .old_impulse = old.impulse.view(),
          .contact = s.contact.view(),
          .impulse = now.impulse.view(),
          .key = now.key.view(),
          .contact_weight_of_body = s.contact_weight.view(),
          .second_count = s.second_count.view()};
}

/// Makes room for what sort_into_bins() and find_contacts() write, apart from the contacts. Call when the State's
/// counts and s.large are set; `max_large`: the largest number of large shapes in one world.
template <class Exec>
void reserve_search(State<Exec>& s, Index max_large) {
  s.centre.fill_zero(s.shape_count);
  reserve_large_groups(s, s.large.size(), max_large);
  s.contacts_of_part.fill_zero(s.shape_count * kSearchParts);
  s.first_of_part.fill_zero(s.shape_count * kSearchParts + 1);
  s.noted.fill_zero(s.shape_count * kNeighbourRows * kNotedPairs);
  s.first_contact.fill_zero(s.shape_count + 1);
  s.shape_in_bin.fill_zero(s.shape_count);
  s.shape_by_bin.fill_zero(s.shape_count);
  s.bin_cursor.fill_zero(s.bin_count);
  s.first_in_bin.fill_zero(s.bin_count + 1);
  for (ContactStore<Exec>& store : s.store) {
    store.begin.fill_zero(s.shape_count);
    store.end.fill_zero(s.shape_count);
  }
  for (auto* of_body : {&s.second_count, &s.second_cursor, &s.contact_weight}) of_body->fill_zero(s.body_count);
  s.progress.fill_zero(1);
}

/// All contacts with gaps up to settings.envelope, at the bodies' present positions.
/// In: shapes, laws, masses, positions and orientations; bins and boxes by sort_into_bins(); the other contact store,
/// from which contacts of the same name take their warm start.
/// Out: pair, contact (but for the step sizes and biases that solve() sets), first_contact, store[parity] with begin,
/// end, key and the warm start in impulse; contact_weight, second_count, and progress. Contacts are ordered by the
/// shape that owns them, in the same order for any number of threads. Nothing else is written; no arrays may alias. On
/// the host the buffers grow where they are too small. On the GPU progress[0].halted is set instead; then all that
/// follows in the step does nothing.
template <class Exec>
void find_contacts(Exec exec, State<Exec>& s, const StepSettings& settings) {
  GONOGO_ASSERT((s.parity == 0 || s.parity == 1) && settings.step > 0 && settings.envelope >= 0);
  GONOGO_ASSERT(s.first_of_part.size() == s.shape_count * kSearchParts + 1);
  const ContactFinder finder = contact_finder(s, settings);
  const Index rows = rows_per_thread(exec, s.shape_count), threads = s.shape_count * (kNeighbourRows / rows);
  beside(
      exec,
      [&](Exec main) {
        for_each_index(main, threads, CountSphereContacts{finder, s.contacts_of_part.view(), s.noted.view(), rows});
      },
      [&](Exec side) {
        for (auto* of_body : {&s.contact_weight, &s.second_count, &s.second_cursor}) clear(side, of_body->view());
        for_each_index(side, s.shape_count, CountOtherContacts{finder, s.contacts_of_part.view()});
      });
  exclusive_scan(exec, s.contacts_of_part.view(), s.first_of_part.view(), s.scratch);
  for_each_index(exec, 1, CheckCapacity{s.first_of_part.view(), s.progress.view(), s.contact_capacity});
  make_room_for_contacts(exec, s);
  const ContactWriter writer = contact_writer(s, finder, settings);
  beside(
      exec,
      [&](Exec main) {
        for_each_index(main, threads,
                       ListSpherePairs{finder, s.first_of_part.view(), s.noted.view(), s.pair.view(), rows});
      },
      [&](Exec side) {
        for_each_index(side, s.shape_count,
                       WriteOtherContacts{writer, s.pair.view(), s.first_contact.view(), s.store[s.parity].begin.view(),
                                          s.store[s.parity].end.view()});
      });
  for_each_counted(exec, contact_count(s), WriteSphereContact{writer, s.pair.view()});
}

// The host's search is compiled once, in simulation/cpu.cpp.
extern template void sort_into_bins(Cpu, State<Cpu>&);
extern template void find_contacts(Cpu, State<Cpu>&, const StepSettings&);

}  // namespace gonogo::sim
