// Hardware graphs against Ocean's (sums of their sorted edge lists).
#include "learning/qubits/graph.h"

#include <algorithm>
#include <set>

#include "tests/support/catch.h"
#include "tests/support/md5.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

/// md5 of the lines "a b" with a < b, ascending.
std::string edge_sum(const HardwareGraph& graph) {
  std::string text;
  for (const auto& [a, b] : graph.couplers()) text += std::to_string(a) + " " + std::to_string(b) + "\n";
  return md5(text);
}

std::size_t max_neighbours(const HardwareGraph& graph) {
  std::size_t max = 0;
  for (Qubit q : graph.qubits()) max = std::max(max, graph.neighbours(q).size());
  return max;
}

}  // namespace

TEST_CASE("graphs have Ocean's labels and couplers") {
  struct Known {
    HardwareGraph graph;
    std::size_t qubits, couplers, degree;
    const char* sum;
  };
  const Known known[] = {
      {graph_named("chimera:1"), 8, 16, 4, "11ed197c02dc741407c3733b95e752cb"},
      {graph_named("chimera:2"), 32, 80, 5, "31d2c11a178edd659abe2ad219f45335"},
      {graph_named("chimera:4"), 128, 352, 6, "f7edd335d08bc0b9434794d9d199f2c8"},
      {graph_named("chimera:8"), 512, 1472, 6, "e8809a5fcf08de96b2f4d66dbbbc0732"},
      {graph_named("chimera:12"), 1152, 3360, 6, "c647c96e2af783510778ec106c3a8e7b"},
      {graph_named("chimera:16"), 2048, 6016, 6, "5742d18fe2ee5e56b3b79ce8156b60db"},
      {graph_named("pegasus:2"), 40, 164, 13, "a56d3c4ef22751dd43186db6cdcac137"},
      {graph_named("pegasus:3"), 128, 704, 14, "f4674aad507df40d47768edb9ab4009f"},
      {graph_named("pegasus:16"), 5640, 40484, 15, "0bea2b1d1a264e77c455db3b10d9aeb7"},
      {pegasus(16, false), 5760, 40656, 15, "da1475c2f6ab186a50083a20181aa8e4"},
      {graph_named("zephyr:2"), 160, 1224, 19, "699244277b90437c22c0ca4ce7f38813"},
      {graph_named("zephyr:6"), 1248, 11400, 20, "90949ef7f5a98ff0cecaf07eddc594fc"},
      {graph_named("zephyr:12"), 4800, 45864, 20, "adaa3a8b82634621d9627e532919444f"},
      {graph_named("zephyr:15"), 7440, 71736, 20, "ebb540d6cd23a71b6ec91fae5cd3ecde"},
  };
  for (const Known& k : known) {
    CAPTURE(k.graph.name());
    CHECK(k.graph.qubits().size() == k.qubits);
    CHECK(k.graph.couplers().size() == k.couplers);
    CHECK(max_neighbours(k.graph) == k.degree);
    CHECK(edge_sum(k.graph) == k.sum);
  }
}

TEST_CASE("a chimera need not be square, nor have four qubits a side") {
  const HardwareGraph graph = graph_named("chimera:3x5:2");
  CHECK(graph.qubits().size() == 2 * 2 * 3 * 5);
  CHECK(graph.couplers().size() == 3 * 5 * 4 + 2 * 5 * 2 + 3 * 4 * 2);  // m n t^2 + (m - 1) n t + m (n - 1) t
  CHECK(graph.name() == "chimera:3x5:2");
}

TEST_CASE("names of graphs that do not exist are refused") {
  for (const char* name : {"chimera", "chimera:", "chimera:0", "chimera:65", "chimera:12y", "pegasus:4:4", "pegasus:1",
                           "hexagon:3", "zephyr:3x3", "chimera:99999999999"}) {
    CAPTURE(name);
    refused([&] { graph_named(name); }, "graph");
  }
}

TEST_CASE("dead qubits take their couplers along") {
  const HardwareGraph full = graph_named("chimera:12");
  const std::vector<Qubit> dead = random_dead_qubits(full, 0.02, 5);
  CHECK(dead.size() == 23);
  CHECK(std::set<Qubit>(dead.begin(), dead.end()).size() == 23);
  CHECK(random_dead_qubits(full, 0.02, 5) == dead);
  CHECK(random_dead_qubits(full, 0.02, 6) != dead);
  const std::pair<Qubit, Qubit> coupler{0, 4};
  const HardwareGraph graph = without(full, dead, std::span(&coupler, 1));
  std::size_t expected = 0;
  for (const auto& [a, b] : full.couplers())
    expected += !std::count(dead.begin(), dead.end(), a) && !std::count(dead.begin(), dead.end(), b) &&
                std::pair(a, b) != coupler;
  CHECK(graph.couplers().size() == expected);
  CHECK(graph.qubits().size() == 1152 - 23);
  CHECK(!graph.works(dead[3]));
  CHECK(!graph.coupled(4, 0));
  CHECK(full.coupled(4, 0));
  const Qubit absent = 1152;
  refused([&] { without(full, std::span(&absent, 1)); }, "1152");
  const std::pair<Qubit, Qubit> none{0, 1};
  refused([&] { without(full, {}, std::span(&none, 1)); }, "no coupler");
}
