// Which contacts act on a body. As body a it owns a contiguous run of contacts (its shapes' runs follow each other); as
// body b it has a list. Both are walked in ascending order, so sums have the same bits for any number of threads.
#pragma once
#include "sim/world/state.h"

namespace gonogo::sim {

/// Fixed bodies get no list: nothing moves them, and a floor under a whole bed would have thousands of contacts to
/// sort and sum.
struct CountSecond {
  View<const Contact> contact;
  View<const BodyMass> mass;
  View<Index> count;  // [body]
  GONOGO_HD void operator()(Index i) const {
    if (!is_fixed(mass[contact[i].body_b])) atomic_increment(count[contact[i].body_b]);
  }
};

struct FillSecond {
  View<const Contact> contact;
  View<const BodyMass> mass;
  View<const Index> first;
  View<Index> cursor;
  View<Index> item;
  GONOGO_HD void operator()(Index i) const {
    const BodyIndex b = contact[i].body_b;
    if (is_fixed(mass[b])) return;
    item[first[b] + atomic_increment(cursor[b])] = i;
  }
};

/// Contacts of a body, in ascending order: owned ones, then those where it is body b and can move.
struct Incidence {
  View<const Index> first_shape, first_contact;  // body -> shapes -> contacts
  View<const Index> first_second, second;        // body -> contacts where it is body b

  GONOGO_HD Index owned_begin(BodyIndex b) const { return first_contact[first_shape[b]]; }
  GONOGO_HD Index owned_end(BodyIndex b) const { return first_contact[first_shape[b + 1]]; }
  GONOGO_HD Index degree(BodyIndex b) const {
    return owned_end(b) - owned_begin(b) + first_second[b + 1] - first_second[b];
  }
};

template <class Exec>
Incidence incidence(State<Exec>& s) {
  return {s.first_shape.view(), s.first_contact.view(), s.first_second.view(), s.second_contact.view()};
}

template <class Exec>
void build_incidence(Exec exec, State<Exec>& s) {
  s.second_count.fill_zero(s.body_count);
  for_each_index(exec, s.contact_count, CountSecond{s.contact.view(), s.mass.view(), s.second_count.view()});
  exclusive_scan(exec, s.second_count.view(), s.first_second.view());
  s.second_cursor.fill_zero(s.body_count);
  s.second_contact.resize(s.contact_count);
  for_each_index(exec, s.contact_count,
                 FillSecond{s.contact.view(), s.mass.view(), s.first_second.view(), s.second_cursor.view(),
                            s.second_contact.view()});
  for_each_index(exec, s.body_count, SortSegment{s.first_second.view(), s.second_contact.view()});
}

}  // namespace gonogo::sim
