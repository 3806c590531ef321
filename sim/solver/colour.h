// Colours for Gauss-Seidel: contacts of one colour share no body whose velocity the sweep changes, so they are updated
// at once. A wheel with hundreds of contacts would need hundreds of colours. Such bodies, and those of mechanisms, keep
// their velocity through a sweep and split their mass instead (split.h), which never overshoots either. Colours follow
// the greedy rule in the order of a hash (Jones & Plassmann 1993). Each contact waits for its neighbours that come
// before it, so any number of threads finds the same colours.
#pragma once
#include "sim/state/incidence.h"

namespace gonogo::sim {

/// Bodies with more contacts are not swept. A contact of two swept bodies has at most 62 neighbours, so 64 colours
/// suffice.
inline constexpr Index kMaxSweptContacts = 32;
inline constexpr Index kNoColour = -1;

/// Whether a sweep changes the body's velocity contact by contact.
GONOGO_HD inline bool is_swept(BodyIndex b, const BodyMass& mass, const Incidence& incidence) {
  if (is_fixed(mass) || mass.slot >= 0) return false;
  const Index owned = incidence.owned_end(b) - incidence.owned_begin(b);
  return owned + incidence.first_second[b + 1] - incidence.first_second[b] <= kMaxSweptContacts;
}

/// A permutation of the integers below 2^32: the finaliser of MurmurHash3 (public domain).
GONOGO_HD inline std::uint32_t shuffled(std::uint32_t i) {
  i = (i ^ (i >> 16)) * 0x85ebca6bu;
  i = (i ^ (i >> 13)) * 0xc2b2ae35u;
  return i ^ (i >> 16);
}

struct Colouring {
  Incidence incidence;
  View<const BodyMass> mass;
  View<const WorldParameters> world;
  View<const Contact> contact;
  View<Index> colour;  // [contact]

  /// Colours the contact if all neighbours before it have colours. Returns whether it has one now. Many threads may
  /// call this at once.
  GONOGO_HD bool try_colour(ContactIndex i) const {
    if (load_relaxed(colour[i]) != kNoColour) return true;
    const Contact& c = contact[i];
    const ContactIndex first = incidence.first_contact[world[c.world].first_shape];
    std::uint64_t taken = 0;
    if (!mark_before(i, first, c.body_a, taken) || !mark_before(i, first, c.body_b, taken)) return false;
    Index free = 0;
    while (taken >> free & 1) ++free;
    store_relaxed(colour[i], free);
    return true;
  }

 private:
  /// Marks the colours of a body's contacts that come before `i`; false if one has none yet.
  GONOGO_HD bool mark_before(ContactIndex i, ContactIndex first, BodyIndex b, std::uint64_t& taken) const {
    if (!is_swept(b, mass[b], incidence)) return true;
    for (ContactIndex k = incidence.owned_begin(b); k < incidence.owned_end(b); ++k)
      if (!mark(i, k, first, taken)) return false;
    for (Index k = incidence.first_second[b]; k < incidence.first_second[b + 1]; ++k)
      if (!mark(i, incidence.second[k], first, taken)) return false;
    return true;
  }

  GONOGO_HD bool mark(ContactIndex i, ContactIndex other, ContactIndex first, std::uint64_t& taken) const {
    if (shuffled(std::uint32_t(other - first)) >= shuffled(std::uint32_t(i - first))) return true;
    const Index its = load_relaxed(colour[other]);
    if (its == kNoColour) return false;
    taken |= std::uint64_t(1) << its;
    return true;
  }
};

template <class Exec>
Colouring colouring(State<Exec>& s, View<Index> colour) {
  return {incidence(s), s.mass.view(), s.world.view(), s.contact.view(), colour};
}

}  // namespace gonogo::sim
