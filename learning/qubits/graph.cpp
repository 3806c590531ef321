#include "learning/qubits/graph.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/format.h"
#include "base/math/random.h"

namespace gonogo::learning {

HardwareGraph::HardwareGraph(std::string name, TopologySize size, std::size_t chip_size, std::vector<Qubit> qubits,
                             const std::vector<std::pair<Qubit, Qubit>>& couplers)
    : name_(std::move(name)),
      size_(size),
      qubits_(std::move(qubits)),
      neighbours_(chip_size),
      works_(chip_size, false) {
  std::sort(qubits_.begin(), qubits_.end());
  for (Qubit q : qubits_) works_[q] = true;
  for (auto [a, b] : couplers) {
    GONOGO_ASSERT(a != b && works(a) && works(b));
    couplers_.emplace_back(std::min(a, b), std::max(a, b));
  }
  std::sort(couplers_.begin(), couplers_.end());
  couplers_.erase(std::unique(couplers_.begin(), couplers_.end()), couplers_.end());
  for (const auto& [a, b] : couplers_) {
    neighbours_[a].push_back(b);
    neighbours_[b].push_back(a);
  }
  for (auto& list : neighbours_) std::sort(list.begin(), list.end());
}

bool HardwareGraph::coupled(Qubit a, Qubit b) const {
  return a < neighbours_.size() && std::binary_search(neighbours_[a].begin(), neighbours_[a].end(), b);
}

HardwareGraph without(const HardwareGraph& graph, std::span<const Qubit> dead_qubits,
                      std::span<const std::pair<Qubit, Qubit>> dead_couplers) {
  std::vector<bool> dead(graph.chip_size(), false);
  for (Qubit q : dead_qubits) {
    if (!graph.works(q))
      throw InputError("graph " + graph.name() + ": qubit " + std::to_string(q) + " is not one of its qubits");
    dead[q] = true;
  }
  std::vector<std::pair<Qubit, Qubit>> gone;
  for (auto [a, b] : dead_couplers) {
    if (!graph.coupled(a, b))
      throw InputError("graph " + graph.name() + ": qubits " + std::to_string(a) + " and " + std::to_string(b) +
                       " have no coupler");
    gone.emplace_back(std::min(a, b), std::max(a, b));
  }
  std::sort(gone.begin(), gone.end());
  std::vector<Qubit> qubits;
  for (Qubit q : graph.qubits())
    if (!dead[q]) qubits.push_back(q);
  std::vector<std::pair<Qubit, Qubit>> couplers;
  for (const auto& pair : graph.couplers())
    if (!dead[pair.first] && !dead[pair.second] && !std::binary_search(gone.begin(), gone.end(), pair))
      couplers.push_back(pair);
  return HardwareGraph(graph.name(), graph.size(), graph.chip_size(), std::move(qubits), couplers);
}

std::vector<Qubit> random_dead_qubits(const HardwareGraph& graph, double share, std::uint64_t seed) {
  if (!(share >= 0 && share < 1))
    throw InputError("share of dead qubits: " + number_text(share, 6) + " is not from 0 to below 1");
  std::vector<Qubit> order = graph.qubits();
  const auto count = std::size_t(std::lround(share * double(order.size())));
  for (std::size_t k = 0; k < count; ++k)  // Fisher and Yates' shuffle, as far as needed
    std::swap(order[k], order[k + random_bits(seed, 0, k) % (order.size() - k)]);
  order.resize(count);
  std::sort(order.begin(), order.end());
  return order;
}

// The three families of graphs: which qubits there are, and which of them couple.

namespace {

using Pairs = std::vector<std::pair<Qubit, Qubit>>;

constexpr std::uint32_t kMaxSize = 64;

// Offsets of Pegasus lines: S0 of the vertical ones, S1 of the horizontal ones.
constexpr std::uint32_t kOffset0[12] = {2, 2, 2, 2, 10, 10, 10, 10, 6, 6, 6, 6};
constexpr std::uint32_t kOffset1[12] = {6, 6, 6, 6, 2, 2, 2, 2, 10, 10, 10, 10};

Qubit chimera_label(const TopologySize& s, std::uint32_t i, std::uint32_t j, std::uint32_t u, std::uint32_t k) {
  return ((i * s.n + j) * 2 + u) * s.t + k;
}

Qubit pegasus_label(const TopologySize& s, std::uint32_t u, std::uint32_t w, std::uint32_t k, std::uint32_t z) {
  return ((u * s.m + w) * 12 + k) * (s.m - 1) + z;
}

Qubit zephyr_label(const TopologySize& s, std::uint32_t u, std::uint32_t w, std::uint32_t k, std::uint32_t j,
                   std::uint32_t z) {
  return (((u * (2 * s.m + 1) + w) * s.t + k) * 2 + j) * s.m + z;
}

/// Not reached by internal couplers: the outermost pieces of the rim.
bool outside_fabric(const TopologySize& s, std::uint32_t w, std::uint32_t k) {
  return (w == 0 && k < 2) || (w == s.m - 1 && k >= 10);
}

std::vector<Qubit> all_qubits(std::size_t count) {
  std::vector<Qubit> qubits(count);
  std::iota(qubits.begin(), qubits.end(), 0u);
  return qubits;
}

void end_to_end(const TopologySize& size, Pairs& couplers) {
  for (int u : {0, 1})
    for (const auto& line : lines(size, u))
      for (std::size_t k = 0; k + 1 < line.size(); ++k) couplers.emplace_back(line[k], line[k + 1]);
}

/// A vertical qubit lies at x = 12 w + k and spans y = 12 z + S0[k] to 11 further; a horizontal one lies at y = 12 w +
/// k and spans x = 12 z + S1[k] to 11 further. They couple where they cross.
void pegasus_internal(const TopologySize& s, Pairs& couplers) {
  for (std::uint32_t w0 = 0; w0 < s.m; ++w0)
    for (std::uint32_t k0 = 0; k0 < 12; ++k0)
      for (std::uint32_t w1 = 0; w1 < s.m; ++w1)
        for (std::uint32_t k1 = 0; k1 < 12; ++k1) {
          const std::uint32_t before0 = k1 < kOffset0[k0], before1 = k0 < kOffset1[k1];
          if (w1 < before0 || w1 - before0 >= s.m - 1 || w0 < before1 || w0 - before1 >= s.m - 1) continue;
          couplers.emplace_back(pegasus_label(s, 0, w0, k0, w1 - before0), pegasus_label(s, 1, w1, k1, w0 - before1));
        }
}

void zephyr_internal(const TopologySize& s, Pairs& couplers) {
  for (std::uint32_t w = 0; w < s.m; ++w)
    for (std::uint32_t z = 0; z < s.m; ++z)
      for (std::uint32_t bits = 0; bits < 16; ++bits) {
        const std::uint32_t i = bits & 1, j = bits >> 1 & 1, a = bits >> 2 & 1, b = bits >> 3;
        const std::uint32_t w0 = 2 * w + 1 + a * 2 * i - a, w1 = 2 * z + 1 + b * 2 * j - b;
        for (std::uint32_t k = 0; k < s.t; ++k)
          for (std::uint32_t h = 0; h < s.t; ++h)
            couplers.emplace_back(zephyr_label(s, 0, w0, k, j, z), zephyr_label(s, 1, w1, h, i, w));
      }
}

std::string size_suffix(std::uint32_t t) { return t == 4 ? "" : ":" + std::to_string(t); }

/// Whole number of `text` at `at`; moves `at` behind it.
std::uint32_t read_size(const std::string& text, std::size_t& at) {
  std::uint32_t value = 0;
  const std::size_t start = at;
  for (; at < text.size() && text[at] >= '0' && text[at] <= '9' && at < start + 4; ++at)
    value = 10 * value + std::uint32_t(text[at] - '0');
  if (at == start || value < 1 || value > kMaxSize)
    throw InputError("graph \"" + text + "\": sizes are whole numbers from 1 to " + std::to_string(kMaxSize));
  return value;
}

}  // namespace

std::vector<std::vector<Qubit>> lines(const TopologySize& s, int u) {
  const auto side = std::uint32_t(u);
  std::vector<std::vector<Qubit>> result;
  if (s.topology == Topology::chimera) {
    for (std::uint32_t across = 0; across < (u == 0 ? s.n : s.m); ++across)
      for (std::uint32_t k = 0; k < s.t; ++k) {
        auto& line = result.emplace_back();
        for (std::uint32_t along = 0; along < (u == 0 ? s.m : s.n); ++along)
          line.push_back(u == 0 ? chimera_label(s, along, across, 0, k) : chimera_label(s, across, along, 1, k));
      }
  } else if (s.topology == Topology::pegasus) {
    for (std::uint32_t w = 0; w < s.m; ++w)
      for (std::uint32_t k = 0; k < 12; ++k) {
        auto& line = result.emplace_back();
        for (std::uint32_t z = 0; z + 1 < s.m; ++z) line.push_back(pegasus_label(s, side, w, k, z));
      }
  } else {
    for (std::uint32_t w = 0; w < 2 * s.m + 1; ++w)
      for (std::uint32_t k = 0; k < s.t; ++k)
        for (std::uint32_t j = 0; j < 2; ++j) {
          auto& line = result.emplace_back();
          for (std::uint32_t z = 0; z < s.m; ++z) line.push_back(zephyr_label(s, side, w, k, j, z));
        }
  }
  return result;
}

HardwareGraph chimera(std::uint32_t m, std::uint32_t n, std::uint32_t t) {
  const TopologySize size{Topology::chimera, m, n, t};
  Pairs couplers;
  end_to_end(size, couplers);
  for (std::uint32_t cell = 0; cell < m * n; ++cell)
    for (std::uint32_t k = 0; k < t * t; ++k) couplers.emplace_back(2 * t * cell + k / t, 2 * t * cell + t + k % t);
  const std::string name = "chimera:" + std::to_string(m) + (n == m ? "" : "x" + std::to_string(n)) + size_suffix(t);
  return HardwareGraph(name, size, 2 * t * m * n, all_qubits(2 * t * m * n), couplers);
}

HardwareGraph pegasus(std::uint32_t m, bool fabric_only) {
  if (m < 2) throw InputError("graph pegasus:" + std::to_string(m) + ": the size must be at least 2");
  const TopologySize size{Topology::pegasus, m, m, 12};
  const std::size_t count = 24 * m * (m - 1);
  Pairs couplers;
  end_to_end(size, couplers);
  for (std::uint32_t line = 0; line < 2 * m * 6; ++line)  // odd couplers: lines 2k and 2k + 1
    for (std::uint32_t z = 0; z + 1 < m; ++z)
      couplers.emplace_back(2 * line * (m - 1) + z, (2 * line + 1) * (m - 1) + z);
  pegasus_internal(size, couplers);
  HardwareGraph full("pegasus:" + std::to_string(m), size, count, all_qubits(count), couplers);
  if (!fabric_only) return full;
  std::vector<Qubit> outside;
  for (std::uint32_t u = 0; u < 2; ++u)
    for (std::uint32_t w = 0; w < m; ++w)
      for (std::uint32_t k = 0; k < 12; ++k)
        for (std::uint32_t z = 0; z + 1 < m; ++z)
          if (outside_fabric(size, w, k)) outside.push_back(pegasus_label(size, u, w, k, z));
  return without(full, outside);
}

HardwareGraph zephyr(std::uint32_t m, std::uint32_t t) {
  const TopologySize size{Topology::zephyr, m, m, t};
  const std::size_t count = 4 * t * m * (2 * m + 1);
  Pairs couplers;
  end_to_end(size, couplers);
  for (std::uint32_t line = 0; line < 2 * (2 * m + 1) * t;
       ++line)  // odd couplers: j = 0 at z with j = 1 at z and z - 1
    for (std::uint32_t z = 0; z < m; ++z)
      for (std::uint32_t a = 0; a < 2 && a <= z; ++a)
        couplers.emplace_back(2 * line * m + z, (2 * line + 1) * m + z - a);
  zephyr_internal(size, couplers);
  return HardwareGraph("zephyr:" + std::to_string(m) + size_suffix(t), size, count, all_qubits(count), couplers);
}

HardwareGraph graph_named(const std::string& name) {
  std::size_t at = name.find(':');
  const std::string family = name.substr(0, at);
  if (at == std::string::npos || (family != "chimera" && family != "pegasus" && family != "zephyr"))
    throw InputError("graph \"" + name + "\" does not exist; use chimera:M, chimera:MxN, pegasus:M or zephyr:M");
  ++at;
  const std::uint32_t m = read_size(name, at);
  std::uint32_t n = m, t = 4;
  if (family == "chimera" && at < name.size() && name[at] == 'x') n = read_size(name, ++at);
  if (family != "pegasus" && at < name.size() && name[at] == ':') t = read_size(name, ++at);
  if (at != name.size()) throw InputError("graph \"" + name + "\": \"" + name.substr(at) + "\" does not belong there");
  if (family == "chimera") return chimera(m, n, t);
  return family == "pegasus" ? pegasus(m) : zephyr(m, t);
}

}  // namespace gonogo::learning
