#include "learning/hardware/crosses.h"

#include <algorithm>

#include "learning/hardware/segments.h"

namespace gonogo::learning {
namespace {

/// The longest cross of a vertical and a horizontal segment of line l; empty arms when no two of them are coupled.
Cross widest_cross(const HardwareGraph& graph, const std::vector<const Segment*>& vertical,
                   const std::vector<const Segment*>& horizontal) {
  Cross best;
  for (const Segment* v : vertical)
    for (const Segment* h : horizontal) {
      if (v->qubits.size() + h->qubits.size() <= best.arm[0].size() + best.arm[1].size()) continue;
      for (Qubit a : v->qubits)
        for (Qubit b : h->qubits)
          if (graph.coupled(a, b)) best = {{v->qubits, h->qubits}, {a, b}};
    }
  return best;
}

}  // namespace

std::vector<Cross> crosses(const HardwareGraph& graph) {
  const std::vector<Segment> part[2] = {segments(graph, 0), segments(graph, 1)};
  const std::size_t line_count = std::min(lines(graph.size(), 0).size(), lines(graph.size(), 1).size());
  std::vector<std::vector<const Segment*>> by_line[2];
  for (int u : {0, 1}) {
    by_line[u].resize(std::max(lines(graph.size(), 0).size(), lines(graph.size(), 1).size()));
    for (const Segment& s : part[u]) by_line[u][s.line].push_back(&s);
  }
  std::vector<Cross> result;
  for (std::size_t l = 0; l < line_count; ++l) {
    Cross cross = widest_cross(graph, by_line[0][l], by_line[1][l]);
    if (!cross.arm[0].empty()) result.push_back(std::move(cross));
  }
  return result;
}

}  // namespace gonogo::learning
