// L D L^T of a symmetric sparse matrix of dense blocks, by fronts; its pattern, and the dense elimination of a front.
#pragma once
#include <Eigen/Core>
#include <Eigen/Sparse>
#include <vector>

namespace gonogo::sim {

// Where the factors of a symmetric sparse matrix fill, and which of their columns are alike.

/// Columns first .. first + width - 1 of L with the rows below them that all of them take as full.
struct ColumnGroup {
  Eigen::Index first = 0, width = 0;
  std::vector<Eigen::Index> row{};  // ascending
  Eigen::Index filled = 0;          // entries of L that merging took as full and that are 0
};

struct FactorPattern {
  std::vector<Eigen::Index> order;  // row of the matrix in each place, by minimum degree (AMD), then by the tree
  std::vector<ColumnGroup> group;   // in the order of columns; a group's first row lies in the group above it
};

/// Pattern of the factors of a square matrix with a symmetric pattern and a full diagonal. Groups merge where that adds
/// few zeros.
FactorPattern factor_pattern(const Eigen::SparseMatrix<double>& a);

// Dense elimination of the first columns of a symmetric front.

/// Replaces the first `count` columns of the lower triangle of f by L, with a unit diagonal that is not stored, and the
/// rest of the lower triangle by the Schur complement; inverse[count]: 1 / D. f: [rows][step], column by column, step a
/// multiple of 4, rows behind `rows` 0. What stands above the diagonal is lost. False for a pivot that is 0 or not a
/// number.
bool eliminate(double* f, Eigen::Index rows, Eigen::Index step, Eigen::Index count, double* inverse);

// Columns with like rows below form a supernode. The front of one holds its columns and, behind them, what they leave
// to later columns: the entries of the matrix plus what its children left. A dense elimination of the first columns
// gives those of L and the part for its parent (Duff & Reid 1983; Liu 1992). Rows are not exchanged, so the matrix must
// be definite, or all its leading minors must be nonzero.

class BlockLdlt {
 public:
  /// size: rows of a block.
  explicit BlockLdlt(Eigen::Index size) : size_(size) {}

  /// Factorises w + blocks, where `blocks` has entries in diagonal blocks alone; both triangles are given. Order and
  /// pattern are found anew when w has another pattern than before. False when a pivot is 0 or not a number.
  bool factorise(const Eigen::SparseMatrix<double>& w, const Eigen::SparseMatrix<double>& blocks);
  /// A x = b in place.
  void solve(Eigen::VectorXd& x) const;

  std::size_t bytes() const { return value_.size() * sizeof(double); }  // of L
  double multiply_adds() const;                                         // of the eliminations of a factorisation

 private:
  using Index = Eigen::Index;
  /// An entry of w and its place in a front.
  struct Entry {
    int from;
    int to;
  };
  struct Supernode {
    Index first = 0, width = 0;  // columns, in blocks
    std::vector<Index> row{};    // of the blocks below the columns, ascending
    Index parent = -1;
    std::vector<Index> place{};  // of each row among the blocks of the parent's front
    std::vector<Entry> entry{};
    std::size_t value = 0;  // of L [columns][step]
    std::size_t left = 0;   // of the part for the parent, on the stack
    Index blocks() const { return width + Index(row.size()); }
  };

  void analyse(const Eigen::SparseMatrix<double>& w);
  bool has_pattern_of(const Eigen::SparseMatrix<double>& w) const;
  Index rows(const Supernode& s) const { return s.blocks() * size_; }
  /// Rows from one column of a front to the next.
  Index step(const Supernode& s) const { return (rows(s) + 3) / 4 * 4; }
  void place_entries(const Eigen::SparseMatrix<double>& w, const std::vector<Index>& node_of,
                     const std::vector<Index>& place_of);
  static Index block_of(const Supernode& s, Index row);
  const double* column(const Supernode& s, Index c) const { return value_.data() + s.value + std::size_t(c * step(s)); }
  void assemble(const Supernode& s, const Eigen::SparseMatrix<double>& w, const Eigen::SparseMatrix<double>& blocks);
  void add_left(const Supernode& child, const Supernode& s);
  template <int Size>
  void add_blocks_left(const Supernode& child, const Supernode& s, Index any_size);
  void forward(const Supernode& s, double* y, double* part) const;
  void backward(const Supernode& s, double* y, double* part) const;

  Index size_ = 1;
  std::vector<int> begin_, inner_;         // pattern of w
  std::vector<Index> order_;               // block of the matrix in each place
  std::vector<Supernode> node_;            // children before parents
  std::vector<std::vector<Index>> child_;  // of each supernode
  /// On 32 bytes, so that packs do not cross lines of the cache.
  using Numbers = std::vector<double, Eigen::aligned_allocator<double>>;
  Numbers value_, front_;                // value_: L
  std::vector<double> inverse_, stack_;  // inverse_: 1 / D
  std::size_t largest_step_ = 0;
};

}  // namespace gonogo::sim
