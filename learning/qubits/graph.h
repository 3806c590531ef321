// Graphs of D-Wave's machines, with Ocean's numbering of qubits (dwave-graphs 1.2).
//
//   chimera m n t  (i, j, u, k) -> ((i n + j) 2 + u) t + k. Qubits of a cell couple across u. Qubits with u = 0 also
//                  couple with the cells above and below, those with u = 1 with the cells left and right.
//   pegasus m      (u, w, k, z) -> ((u m + w) 12 + k)(m - 1) + z. Fabric only: without the qubits at the rim that have
//                  no internal coupler. Boothby, Bunyk, Raymond, Roy, arXiv:2003.00133.
//   zephyr m t     (u, w, k, j, z) -> (((u (2m + 1) + w) t + k) 2 + j) m + z. D-Wave report 14-1056A-A.
//
// In all three, a qubit is a piece of a vertical (u = 0) or horizontal (u = 1) line. Pieces of a line couple end to
// end.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gonogo::learning {

using Qubit = std::uint32_t;

enum class Topology { chimera, pegasus, zephyr };

struct TopologySize {
  Topology topology = Topology::chimera;
  std::uint32_t m = 1, n = 1, t = 4;  // n: chimera only; t: chimera and zephyr
  bool operator==(const TopologySize&) const = default;
};

class HardwareGraph {
 public:
  /// couplers: pairs of different working qubits in either order, each once.
  HardwareGraph(std::string name, TopologySize size, std::size_t chip_size, std::vector<Qubit> qubits,
                const std::vector<std::pair<Qubit, Qubit>>& couplers);

  const std::string& name() const { return name_; }  // "chimera:12", "zephyr:6:4"
  const TopologySize& size() const { return size_; }
  std::size_t chip_size() const { return neighbours_.size(); }                        // dead qubits included
  const std::vector<Qubit>& qubits() const { return qubits_; }                        // working ones, ascending
  const std::vector<std::pair<Qubit, Qubit>>& couplers() const { return couplers_; }  // (a < b), ascending
  std::span<const Qubit> neighbours(Qubit q) const { return neighbours_[q]; }         // ascending
  bool works(Qubit q) const { return q < works_.size() && works_[q]; }
  bool coupled(Qubit a, Qubit b) const;

 private:
  std::string name_;
  TopologySize size_;
  std::vector<Qubit> qubits_;
  std::vector<std::pair<Qubit, Qubit>> couplers_;
  std::vector<std::vector<Qubit>> neighbours_;
  std::vector<bool> works_;
};

HardwareGraph chimera(std::uint32_t m, std::uint32_t n, std::uint32_t t = 4);
HardwareGraph pegasus(std::uint32_t m, bool fabric_only = true);
HardwareGraph zephyr(std::uint32_t m, std::uint32_t t = 4);

/// "chimera:M[:T]", "chimera:MxN[:T]", "pegasus:M" or "zephyr:M[:T]". Throws InputError for others and sizes above 64.
HardwareGraph graph_named(const std::string& name);

/// The graph without these qubits, their couplers, and these couplers. Throws InputError for qubits and couplers that
/// the graph does not have.
HardwareGraph without(const HardwareGraph& graph, std::span<const Qubit> dead_qubits,
                      std::span<const std::pair<Qubit, Qubit>> dead_couplers = {});

/// round(share x working qubits) random working qubits, ascending. Deterministic.
std::vector<Qubit> random_dead_qubits(const HardwareGraph& graph, double share, std::uint64_t seed);

/// The lines of one direction, each with its qubits end to end, dead ones included. Lines l of u = 0 and u = 1 have the
/// same position in their direction.
std::vector<std::vector<Qubit>> lines(const TopologySize& size, int u);

}  // namespace gonogo::learning
