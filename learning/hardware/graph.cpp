#include "learning/hardware/graph.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/format.h"
#include "base/random.h"

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

}  // namespace gonogo::learning
