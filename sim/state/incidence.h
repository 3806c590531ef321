// Which contacts act on a body. Where it is body a, its contacts are one contiguous run; where it is body b, a list
// names them. Both are read in ascending order, so sums have the same bits for any number of threads.
#pragma once
#include "sim/state/state.h"

namespace gonogo::sim {

/// Writes the lists, in any order.
struct FillSecond {
  View<const Contact> contact;
  View<const BodyMass> mass;
  View<const Index> first;
  View<Index> cursor;
  View<Index> item;
  GONOGO_HD void operator()(ContactIndex i) const {
    const BodyIndex b = contact[i].body_b;
    if (is_fixed(mass[b])) return;
    item[first[b] + atomic_increment(cursor[b])] = i;
  }
};

/// Sorts the lists: each contact counts the smaller ones of the same body. One contact per thread, so that hundreds of
/// threads sort the hundreds of contacts of a wheel.
struct RankSecond {
  View<const Contact> contact;
  View<const BodyMass> mass;
  View<const Index> first, found;
  View<Index> sorted;
  View<Index> slot;  // [contact] position in the list, or -1
  GONOGO_HD void operator()(ContactIndex i) const {
    const BodyIndex b = contact[i].body_b;
    if (is_fixed(mass[b])) {
      slot[i] = -1;
      return;
    }
    Index rank = first[b];
    for (Index k = first[b]; k < first[b + 1]; ++k) rank += found[k] < i ? 1 : 0;
    sorted[rank] = i;
    slot[i] = rank;
  }
};

/// Contacts of a body, in ascending order: those it owns, then those where it is body b and can move.
struct Incidence {
  View<const Index> first_shape, first_contact;  // body -> shapes -> contacts
  View<const Index> first_second, second;        // body -> contacts where it is body b

  GONOGO_HD Index owned_begin(BodyIndex b) const { return first_contact[first_shape[b]]; }
  GONOGO_HD Index owned_end(BodyIndex b) const { return first_contact[first_shape[b + 1]]; }
};

template <class Exec>
Incidence incidence(State<Exec>& s) {
  return {s.first_shape.view(), s.first_contact.view(), s.first_second.view(), s.second_contact.view()};
}

/// Call after find_contacts().
template <class Exec>
void build_incidence(Exec exec, State<Exec>& s) {
  const Counted contacts = contact_count(s);
  exclusive_scan(exec, s.second_count.view(), s.first_second.view(), s.scratch);
  for_each_counted(exec, contacts,
                   FillSecond{s.contact.view(), s.mass.view(), s.first_second.view(), s.second_cursor.view(),
                              s.second_found.view()});
  for_each_counted(exec, contacts,
                   RankSecond{s.contact.view(), s.mass.view(), s.first_second.view(), s.second_found.view(),
                              s.second_contact.view(), s.second_slot.view()});
}

}  // namespace gonogo::sim
