#include <algorithm>

#include "base/error.h"
#include "base/random.h"
#include "learning/hardware/biclique_chains.h"

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
  chains.trim();
  Embedding embedding;
  embedding.chains = chains.chains();
  VariablePairs pairs;
  for (std::size_t i = 0; i < visible; ++i)
    for (std::size_t j = 0; j < hidden; ++j) pairs.emplace_back(std::uint32_t(i), std::uint32_t(visible + j));
  for (auto& chain : embedding.chains) std::sort(chain.begin(), chain.end());
  embedding.uncoupled = uncoupled_pairs(graph, embedding.chains, pairs);
  return embedding;
}

}  // namespace gonogo::learning
