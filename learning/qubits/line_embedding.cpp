#include "learning/qubits/line_embedding.h"

#include <algorithm>

#include "base/error.h"
#include "base/math/random.h"
#include "learning/qubits/line_chains.h"

namespace gonogo::learning {
namespace {

/// One segment for each line of either direction, and how many chosen segments of the other direction each crosses.
class Choice {
 public:
  explicit Choice(const HardwareGraph& graph) : side_{segments(graph, 0), segments(graph, 1)} {
    cross_ = crossings(graph, side_[0], side_[1]);
    for (int u : {0, 1}) {
      parts_[u].resize(lines(graph.size(), u).size());
      for (std::size_t s = 0; s < side_[u].size(); ++s) parts_[u][side_[u][s].line].push_back(s);
      for (std::size_t l = 0; l < parts_[u].size(); ++l)
        if (!parts_[u][l].empty()) chosen_[u].push_back(longest(u, l));
    }
  }
  std::size_t line_count(int u) const { return chosen_[u].size(); }
  const Segment& segment(int u, std::size_t k) const { return side_[u][chosen_[u][k]]; }
  /// All segments of the line of chosen segment k.
  std::vector<const Segment*> line_segments(int u, std::size_t k) const {
    std::vector<const Segment*> all;
    for (std::size_t s : parts_[u][segment(u, k).line]) all.push_back(&side_[u][s]);
    return all;
  }

  /// Each line takes the segment that crosses most of the other direction's chosen ones, until nothing changes.
  void improve() {
    bool changed = true;
    for (int round = 0; changed && round < 50; ++round) {
      changed = false;
      for (int u : {0, 1})
        for (std::size_t& s : chosen_[u])
          for (std::size_t other : parts_[u][side_[u][s].line])
            if (crossed(u, other) > crossed(u, s)) {
              s = other;
              changed = true;
            }
    }
  }

  /// Leaves out, one after the other, lines that cross fewest; among equals the last, so that the rest lies together.
  void reduce(std::size_t vertical, std::size_t horizontal) {
    const std::size_t wanted[2] = {vertical, horizontal};
    while (chosen_[0].size() > vertical || chosen_[1].size() > horizontal) {
      int side = -1;
      std::size_t worst = 0;
      double lowest = 2;
      for (int u : {0, 1}) {
        if (chosen_[u].size() <= wanted[u]) continue;
        for (std::size_t k = 0; k < chosen_[u].size(); ++k) {
          const double share =
              double(crossed(u, chosen_[u][k])) / double(std::max<std::size_t>(1, chosen_[1 - u].size()));
          if (share > lowest) continue;
          lowest = share;
          side = u;
          worst = k;
        }
      }
      chosen_[side].erase(chosen_[side].begin() + std::ptrdiff_t(worst));
    }
  }

 private:
  std::size_t longest(int u, std::size_t line) const {
    std::size_t best = parts_[u][line][0];
    for (std::size_t s : parts_[u][line])
      if (side_[u][s].qubits.size() > side_[u][best].qubits.size()) best = s;
    return best;
  }
  std::size_t crossed(int u, std::size_t s) const {
    std::size_t count = 0;
    for (std::size_t other : chosen_[1 - u]) count += std::size_t(u == 0 ? cross_[s][other] : cross_[other][s]);
    return count;
  }

  std::vector<Segment> side_[2];
  std::vector<std::vector<std::size_t>> parts_[2];  // segments of each line
  std::vector<std::size_t> chosen_[2];              // by line
  std::vector<std::vector<char>> cross_;
};

/// A chain's straight part: qubits `begin` to before `end` of a segment.
struct Piece {
  const Segment* segment = nullptr;
  std::size_t begin = 0, end = 0;
  bool operator==(const Piece&) const = default;
};

/// Which piece of its line each variable starts from, so that most pairs find a coupler once chains have grown over
/// what is left over. Variable after variable tries the other segments of its line and shorter pieces, which free
/// qubits for others to pass; a change that gains pairs stays.
class PieceSearch {
 public:
  PieceSearch(const HardwareGraph& graph, const Choice& choice, std::size_t visible, std::size_t hidden)
      : graph_(graph), visible_(visible) {
    for (std::size_t v = 0; v < visible + hidden; ++v) {
      const int u = v < visible ? 0 : 1;
      const std::size_t k = u == 0 ? v : v - visible;
      piece_.push_back(whole(choice.segment(u, k)));
      others_.push_back(choice.line_segments(u, k));
    }
    coupled_ = pairs();
  }
  BicliqueChains grown() const {
    Chains chains;
    for (const Piece& p : piece_)
      chains.emplace_back(p.segment->qubits.begin() + std::ptrdiff_t(p.begin),
                          p.segment->qubits.begin() + std::ptrdiff_t(p.end));
    BicliqueChains grown(graph_, visible_, std::move(chains));
    grown.lengthen();
    return grown;
  }
  void improve() {
    climb();
    if (double(coupled_) < kEnough * double(all_pairs())) shake();
  }

 private:
  static constexpr std::size_t kMaxCut = 3;            // qubits off an end: more cost more than they make way for
  static constexpr std::size_t kShakes = 4000;         // random changes
  static constexpr std::size_t kMaxWork = 25'000'000;  // of each of the two searches: seconds
  static constexpr double kEnough = 0.85;              // of the pairs: the longer search is for masks that leave fewer
  static constexpr double kMaxLoss = 4;                // pairs that a random change may cost at first

  static Piece whole(const Segment& s) { return {&s, 0, s.qubits.size()}; }
  static Piece cut(const Segment& s, std::size_t count, bool front) {
    count = std::min(count, s.qubits.size() - 1);
    return {&s, front ? count : 0, s.qubits.size() - (front ? 0 : count)};
  }
  std::size_t all_pairs() const { return visible_ * (piece_.size() - visible_); }
  /// Pairs that the present pieces lead to; what that took counts as work.
  std::size_t pairs() {
    const BicliqueChains chains = grown();
    work_ += chains.looks() + graph_.couplers().size();
    return chains.coupled_pairs();
  }

  void climb() {
    for (bool changed = true; changed;) {
      changed = false;
      for (std::size_t v = 0; v < piece_.size() && coupled_ < all_pairs(); ++v) changed = climb(v) || changed;
    }
  }

  bool climb(std::size_t v) {
    const std::size_t before = coupled_;
    Piece best = piece_[v];
    for (const Segment* s : others_[v])
      for (std::size_t count = 0; count <= kMaxCut; ++count)
        for (bool front : {true, false}) {
          if ((count == 0 && !front) || work_ > kMaxWork) continue;
          piece_[v] = cut(*s, count, front);
          const std::size_t found = pairs();
          if (found > coupled_) {
            coupled_ = found;
            best = piece_[v];
          }
        }
    piece_[v] = best;
    return coupled_ > before;
  }

  /// Random changes that may cost pairs, fewer and fewer of them: out of the climb's dead end.
  void shake() {
    std::vector<Piece> best = piece_;
    std::size_t now = coupled_;
    work_ = 0;
    for (std::size_t k = 0; k < kShakes && work_ <= kMaxWork; ++k) {
      const auto draw = [&](std::uint64_t stream, std::size_t below) { return random_bits(1, stream, k) % below; };
      const std::size_t v = draw(1, piece_.size());
      const Piece before = piece_[v];
      piece_[v] = cut(*others_[v][draw(2, others_[v].size())], draw(5, 2) * draw(3, kMaxCut + 1), draw(4, 2) == 0);
      if (piece_[v] == before) continue;
      const std::size_t found = pairs();
      if (double(found) + kMaxLoss * (1 - double(k) / kShakes) < double(now)) {
        piece_[v] = before;
        continue;
      }
      now = found;
      if (now > coupled_) {
        coupled_ = now;
        best = piece_;
      }
    }
    piece_ = best;
  }

  const HardwareGraph& graph_;
  std::size_t visible_;
  std::vector<Piece> piece_;
  std::vector<std::vector<const Segment*>> others_;  // all segments of the variable's line
  std::size_t coupled_ = 0, work_ = 0;               // pairs coupled so far; qubits and couplers looked at
};

/// The chains of a biclique with sides of `first` and `second` variables, trimmed, and the pairs that they leave out.
Embedding trimmed(const HardwareGraph& graph, BicliqueChains& chains, std::size_t first, std::size_t second) {
  chains.trim();
  Embedding embedding;
  embedding.chains = chains.chains();
  VariablePairs pairs;
  for (std::size_t i = 0; i < first; ++i)
    for (std::size_t j = 0; j < second; ++j) pairs.emplace_back(std::uint32_t(i), std::uint32_t(first + j));
  for (auto& chain : embedding.chains) std::sort(chain.begin(), chain.end());
  embedding.uncoupled = uncoupled_pairs(graph, embedding.chains, pairs);
  return embedding;
}

}  // namespace

Embedding embed_biclique(const HardwareGraph& graph, std::size_t visible, std::size_t hidden) {
  Choice choice(graph);
  if (visible > choice.line_count(0) || hidden > choice.line_count(1))
    throw InputError("graph " + graph.name() + ": " + std::to_string(visible) + " visible and " +
                     std::to_string(hidden) + " hidden variables do not fit; it has " +
                     std::to_string(choice.line_count(0)) + " vertical and " + std::to_string(choice.line_count(1)) +
                     " horizontal lines");
  choice.improve();
  choice.reduce(visible, hidden);
  choice.improve();
  PieceSearch search(graph, choice, visible, hidden);
  search.improve();
  BicliqueChains chains = search.grown();
  return trimmed(graph, chains, visible, hidden);
}

// Bicliques with one long side: the variables of the short side are on crosses, those of the long side on what is left
// of the lines of both directions. C12 holds K(96 - 2 b, b).

namespace {

std::vector<Qubit> qubits_of(const Cross& cross) {
  std::vector<Qubit> chain = cross.arm[0];
  chain.insert(chain.end(), cross.arm[1].begin(), cross.arm[1].end());
  return chain;
}

/// The longest crosses; among equals the first, so that they lie together and the other chains can be short.
Chains short_side(const HardwareGraph& graph, std::size_t count) {
  std::vector<Cross> all = crosses(graph);
  std::stable_sort(all.begin(), all.end(), [](const Cross& a, const Cross& b) {
    return a.arm[0].size() + a.arm[1].size() > b.arm[0].size() + b.arm[1].size();
  });
  Chains chains;
  for (std::size_t k = 0; k < std::min(count, all.size()); ++k) chains.push_back(qubits_of(all[k]));
  return chains;
}

/// A segment outside the crosses, and how many of them it can be coupled with.
struct Candidate {
  const Segment* segment = nullptr;
  std::size_t crosses = 0;
};

/// The best segment of every line of both directions, best first.
std::vector<Candidate> candidates(const HardwareGraph& graph, const std::vector<Segment>& segments,
                                  const Chains& crosses) {
  constexpr std::size_t kNone = SIZE_MAX;
  std::vector<std::size_t> owner(graph.chip_size(), kNone);
  for (std::size_t c = 0; c < crosses.size(); ++c)
    for (Qubit q : crosses[c]) owner[q] = c;
  std::vector<Candidate> result;
  for (const Segment& segment : segments) {
    const auto used = [&](Qubit q) { return owner[q] != kNone; };
    if (std::any_of(segment.qubits.begin(), segment.qubits.end(), used)) continue;
    std::vector<char> met(crosses.size(), 0);
    for (Qubit q : segment.qubits)
      for (Qubit next : graph.neighbours(q))
        if (used(next)) met[owner[next]] = 1;
    const Candidate here{&segment, std::size_t(std::count(met.begin(), met.end(), 1))};
    const bool same_line = !result.empty() && result.back().segment->line == segment.line;
    if (!same_line)
      result.push_back(here);
    else if (here.crosses > result.back().crosses)
      result.back() = here;
  }
  return result;
}

}  // namespace

Embedding embed_crossed_biclique(const HardwareGraph& graph, std::size_t wide, std::size_t narrow) {
  const Chains shorter = short_side(graph, narrow);
  const std::vector<Segment> vertical = segments(graph, 0), horizontal = segments(graph, 1);
  std::vector<Candidate> all = candidates(graph, vertical, shorter);
  for (const Candidate& c : candidates(graph, horizontal, shorter)) all.push_back(c);
  if (shorter.size() < narrow || all.size() < wide)
    throw InputError("graph " + graph.name() + ": sides of " + std::to_string(wide) + " and " + std::to_string(narrow) +
                     " variables do not fit; beside " + std::to_string(shorter.size()) +
                     " variables on crosses it has " + std::to_string(all.size()) + " lines");
  std::stable_sort(all.begin(), all.end(),
                   [](const Candidate& a, const Candidate& b) { return a.crosses > b.crosses; });
  Chains start;
  for (std::size_t k = 0; k < wide; ++k) start.push_back(all[k].segment->qubits);
  start.insert(start.end(), shorter.begin(), shorter.end());
  BicliqueChains chains(graph, wide, std::move(start));
  chains.lengthen();
  return trimmed(graph, chains, wide, narrow);
}

Embedding embed_two_sides(const HardwareGraph& graph, std::size_t left, std::size_t right) {
  const std::size_t line_count = std::min(lines(graph.size(), 0).size(), lines(graph.size(), 1).size());
  if (std::max(left, right) <= line_count) return embed_biclique(graph, left, right);
  if (left >= right) return embed_crossed_biclique(graph, left, right);
  Embedding found = embed_crossed_biclique(graph, right, left);
  std::rotate(found.chains.begin(), found.chains.begin() + std::ptrdiff_t(right), found.chains.end());
  for (auto& [a, b] : found.uncoupled) {
    const std::uint32_t of_right = a + std::uint32_t(left);
    a = b - std::uint32_t(right);
    b = of_right;
  }
  std::sort(found.uncoupled.begin(), found.uncoupled.end());
  return found;
}

namespace {

Chains chains_of(const std::vector<Cross>& crosses) {
  Chains chains;
  for (const Cross& cross : crosses) {
    auto& chain = chains.emplace_back(cross.arm[0]);
    chain.insert(chain.end(), cross.arm[1].begin(), cross.arm[1].end());
    std::sort(chain.begin(), chain.end());
  }
  return chains;
}

VariablePairs all_pairs(std::size_t count) {
  VariablePairs pairs;
  for (std::uint32_t a = 0; a < count; ++a)
    for (std::uint32_t b = a + 1; b < count; ++b) pairs.emplace_back(a, b);
  return pairs;
}

/// Leaves out, one after the other, the cross that misses most others; among equals the last.
void reduce(const HardwareGraph& graph, std::vector<Cross>& crosses, std::size_t wanted) {
  while (crosses.size() > wanted) {
    std::vector<std::size_t> missed(crosses.size(), 0);
    for (const auto& [a, b] : uncoupled_pairs(graph, chains_of(crosses), all_pairs(crosses.size()))) {
      ++missed[a];
      ++missed[b];
    }
    std::size_t worst = crosses.size() - 1;
    for (std::size_t k = crosses.size(); k-- > 0;)
      if (missed[k] > missed[worst]) worst = k;
    // without misses all of the surplus goes at once
    if (missed[worst] == 0)
      crosses.resize(wanted);
    else
      crosses.erase(crosses.begin() + std::ptrdiff_t(worst));
  }
}

/// Takes qubits off one end of an arm while the pairs of chains keep a coupler.
void trim_arm(ChainCouplers& couplers, std::vector<Qubit>& arm, Qubit joint, bool front) {
  while (arm.size() > 1) {
    const Qubit q = front ? arm.front() : arm.back();
    if (q == joint || !couplers.can_spare(q)) return;
    couplers.remove(q);
    if (front)
      arm.erase(arm.begin());
    else
      arm.pop_back();
  }
}

}  // namespace

Embedding embed_clique(const HardwareGraph& graph, std::size_t variables) {
  std::vector<Cross> chosen = crosses(graph);
  if (chosen.size() < variables)
    throw InputError("graph " + graph.name() + ": " + std::to_string(variables) +
                     " variables that are all coupled do not fit; at most " + std::to_string(chosen.size()) + " do");
  reduce(graph, chosen, variables);
  // Two lines cross twice. The vertical arm of the earlier with the horizontal arm of the later is the crossing that is
  // kept where both exist: first the tops of the vertical arms and the right ends of the horizontal ones go.
  ChainCouplers couplers(graph, chains_of(chosen));
  for (Cross& cross : chosen) trim_arm(couplers, cross.arm[0], cross.joint[0], true);
  for (Cross& cross : chosen) trim_arm(couplers, cross.arm[1], cross.joint[1], false);
  for (Cross& cross : chosen) trim_arm(couplers, cross.arm[0], cross.joint[0], false);
  for (Cross& cross : chosen) trim_arm(couplers, cross.arm[1], cross.joint[1], true);
  Embedding embedding;
  embedding.chains = chains_of(chosen);
  embedding.uncoupled = uncoupled_pairs(graph, embedding.chains, all_pairs(variables));
  return embedding;
}

}  // namespace gonogo::learning
