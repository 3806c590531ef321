// Colours for Gauss-Seidel against the greedy rule taken literally.
#include "sim/solver/split.h"

#include <algorithm>
#include <numeric>
#include <set>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/draw.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

/// Contacts between bodies of one world with one shape each, in the order of the first body.
struct Graph {
  Index bodies;
  std::vector<Contact> contact;
  std::vector<BodyMass> mass;
  std::vector<WorldParameters> world = std::vector<WorldParameters>(1);
  std::vector<Index> first_shape, first_contact, first_second, second, colour;

  Incidence incidence() {
    return {{first_shape.data(), Index(first_shape.size())},
            {first_contact.data(), Index(first_contact.size())},
            {first_second.data(), Index(first_second.size())},
            {second.data(), Index(second.size())}};
  }
  Colouring colouring() {
    return {incidence(),
            {mass.data(), Index(mass.size())},
            {world.data(), 1},
            {contact.data(), Index(contact.size())},
            {colour.data(), Index(colour.size())}};
  }
};

BodyMass free_body() {
  BodyMass m;
  m.inverse_mass = m.inverse_inertia_B = {1, 1, 1};
  return m;
}

/// Body 0 is fixed, body 1 jointed, body 2 touches forty others; each of the rest touches some that come after it.
Graph random_graph(std::uint64_t seed, Index bodies) {
  Draw draw(seed);
  std::vector<std::set<BodyIndex>> others(std::size_t(bodies), std::set<BodyIndex>{});
  for (BodyIndex b = 3; b < 43; ++b) others[2].insert(b);
  for (BodyIndex a = 0; a < bodies; ++a)
    for (int k = 0; k < 4; ++k)
      if (a + 1 < bodies && a != 2) others[a].insert(a + 1 + draw.below(std::min<Index>(12, bodies - a - 1)));
  Graph g;
  g.bodies = bodies;
  g.mass.assign(std::size_t(bodies), free_body());
  g.mass[0] = BodyMass{};
  g.mass[1].slot = 0;
  g.first_shape.resize(std::size_t(bodies) + 1);
  std::iota(g.first_shape.begin(), g.first_shape.end(), 0);
  std::vector<std::vector<Index>> second(others.size());
  for (BodyIndex a = 0; a < bodies; ++a) {
    g.first_contact.push_back(Index(g.contact.size()));
    for (const BodyIndex b : others[a]) {
      second[b].push_back(Index(g.contact.size()));
      Contact c{};
      c.body_a = a;
      c.body_b = b;
      g.contact.push_back(c);
    }
  }
  g.first_contact.push_back(Index(g.contact.size()));
  for (const auto& list : second) {
    g.first_second.push_back(Index(g.second.size()));
    g.second.insert(g.second.end(), list.begin(), list.end());
  }
  g.first_second.push_back(Index(g.second.size()));
  g.colour.assign(g.contact.size(), kNoColour);
  return g;
}

bool share_a_swept_body(Graph& g, const Contact& a, const Contact& b) {
  for (const BodyIndex x : {a.body_a, a.body_b})
    if ((x == b.body_a || x == b.body_b) && is_swept(x, g.mass[x], g.incidence())) return true;
  return false;
}

std::vector<Index> greedy(Graph& g) {
  std::vector<Index> order(g.contact.size()), colour(g.contact.size(), kNoColour);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [](Index a, Index b) { return shuffled(std::uint32_t(a)) < shuffled(std::uint32_t(b)); });
  for (const Index i : order) {
    std::set<Index> taken;
    for (const Index k : order)
      if (colour[k] != kNoColour && share_a_swept_body(g, g.contact[i], g.contact[k])) taken.insert(colour[k]);
    while (taken.count(colour[i] = colour[i] + 1) > 0) {
    }
  }
  return colour;
}

}  // namespace

TEST_CASE("contacts of one colour share no body that a sweep moves, whatever the order in which they are coloured") {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    Graph g = random_graph(seed, 120);
    const std::vector<Index> expected = greedy(g);
    for (const bool backwards : {false, true}) {
      std::fill(g.colour.begin(), g.colour.end(), kNoColour);
      const Index count = Index(g.contact.size());
      for (Index left = count; left > 0;) {
        left = 0;
        for (Index i = 0; i < count; ++i) left += g.colouring().try_colour(backwards ? count - 1 - i : i) ? 0 : 1;
      }
      CHECK(g.colour == expected);
    }
    for (std::size_t i = 0; i < g.contact.size(); ++i)
      for (std::size_t k = 0; k < i; ++k)
        if (share_a_swept_body(g, g.contact[i], g.contact[k])) CHECK(g.colour[i] != g.colour[k]);
    CHECK(*std::max_element(g.colour.begin(), g.colour.end()) < 24);
  }
}

TEST_CASE("fixed and jointed bodies and bodies with many contacts take no part in a sweep") {
  Graph g = random_graph(7, 120);
  for (BodyIndex b = 0; b < g.bodies; ++b) {
    const auto touches = [b](const Contact& c) { return c.body_a == b || c.body_b == b; };
    const auto contacts = std::count_if(g.contact.begin(), g.contact.end(), touches);
    CHECK(is_swept(b, g.mass[b], g.incidence()) == (b > 1 && contacts <= kMaxSweptContacts));
  }
}
