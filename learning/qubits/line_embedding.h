// Embeddings on the lines of a graph: complete bipartite problems and complete ones.
#pragma once
#include "learning/qubits/embedding.h"

namespace gonogo::learning {

/// Couples every visible variable (0 ... visible - 1) with every hidden one (visible ...). Visible variables are on
/// vertical lines, hidden ones on horizontal lines. Each takes the unbroken part of its line that couples the most
/// pairs; the lines with the fewest crossings stay unused. Deterministic. Throws InputError when there are too few
/// lines.
Embedding embed_biclique(const HardwareGraph& graph, std::size_t visible, std::size_t hidden);

/// The same for a long side and a short one. Variables of the short side (the last `narrow`) are on crosses of a
/// vertical and a horizontal line, those of the long side on the lines that are left, of both directions.
/// Deterministic. Throws InputError when there are too few lines.
Embedding embed_crossed_biclique(const HardwareGraph& graph, std::size_t wide, std::size_t narrow);

/// The first of the two unless a side is longer than the lines of a direction. Variables of the left side come first.
Embedding embed_two_sides(const HardwareGraph& graph, std::size_t left, std::size_t right);

/// Couples every variable with every other. Variable v is on parts of a vertical line and of the horizontal line of the
/// same number, joined where they cross (Choi, arXiv:1001.3116; Boothby, King, Roy, arXiv:1507.04774). Deterministic.
Embedding embed_clique(const HardwareGraph& graph, std::size_t variables);

}  // namespace gonogo::learning
