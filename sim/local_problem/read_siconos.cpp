#include "sim/local_problem/read.h"
#include "sim/local_problem/words.h"

namespace gonogo::sim {
namespace {

constexpr int kMaxRows = 10'000'000, kMaxEntries = 2'000'000'000;

void read_dense(Words& in, TripletMatrix& a) {
  in.integer("the number of rows, again,", a.rows, a.rows);
  in.integer("the number of columns, again,", a.columns, a.columns);
  in.require_left("the matrix", double(a.rows) * a.columns);
  for (int column = 0; column < a.columns; ++column)
    for (int row = 0; row < a.rows; ++row) {
      const double value = in.number("matrix entry (" + std::to_string(row) + ", " + std::to_string(column) + ")");
      if (value != 0) a.entry.push_back({row, column, value});
    }
}

/// Last row (column) of each block line, plus one; ends with the size of the matrix.
std::vector<int> block_ends(Words& in, const std::string& what, int count, int size) {
  in.require_left(what, count);
  std::vector<int> end;
  for (int i = 0; i < count; ++i)
    end.push_back(in.integer(what + "[" + std::to_string(i) + "]", end.empty() ? 1 : end.back() + 1, size));
  if (end.empty() || end.back() != size)
    in.fail(what + " ends at " + std::to_string(end.empty() ? 0 : end.back()) + "; the size of the matrix, " +
            std::to_string(size) + ", is needed");
  return end;
}

std::vector<int> ascending(Words& in, const std::string& what, int count, int high) {
  in.require_left(what, count);
  std::vector<int> values;
  for (int i = 0; i < count; ++i)
    values.push_back(in.integer(what + "[" + std::to_string(i) + "]", values.empty() ? 0 : values.back(), high));
  return values;
}

void read_block(Words& in, TripletMatrix& a, int row, int rows, int column, int columns) {
  in.require_left("a block", double(rows) * columns);
  for (int c = 0; c < columns; ++c)
    for (int r = 0; r < rows; ++r)
      if (const double value = in.number("a block's entry"); value != 0)
        a.entry.push_back({row + r, column + c, value});
}

/// Blocks, block lines and columns, their ends; where each line starts among the blocks; column of each block; then the
/// blocks, each behind its number, by columns.
void read_sparse_blocks(Words& in, TripletMatrix& a) {
  const int blocks = in.integer("the number of blocks", 1, kMaxRows);
  const int lines = in.integer("the number of block rows", 1, a.rows);
  const int block_columns = in.integer("the number of block columns", 1, a.columns);
  const auto row_end = block_ends(in, "block row ends", lines, a.rows);
  const auto column_end = block_ends(in, "block column ends", block_columns, a.columns);
  const int starts = in.integer("the number of row starts", 1, lines + 1);
  const int columns = in.integer("the number of block columns listed", blocks, blocks);
  const auto first = ascending(in, "row starts", starts, blocks);
  in.require_left("block columns", columns);
  std::vector<int> column;
  for (int k = 0; k < columns; ++k) column.push_back(in.integer("a block's column", 0, block_columns - 1));
  for (int line = 0; line + 1 < starts; ++line)
    for (int k = first[line]; k < first[line + 1]; ++k) {
      in.integer("a block's number", k, k);
      const int row = line ? row_end[line - 1] : 0, left = column[k] ? column_end[column[k] - 1] : 0;
      read_block(in, a, row, row_end[line] - row, left, column_end[column[k]] - left);
    }
  if (first.back() != blocks)
    in.fail("the row starts end at " + std::to_string(first.back()) + "; the number of blocks, " +
            std::to_string(blocks) + ", is needed");
}

void read_entry(Words& in, TripletMatrix& a, int column) {
  const int row = in.integer("an entry's row", 0, a.rows - 1);
  if (column < 0) column = in.integer("an entry's column", 0, a.columns - 1);
  in.expect(":");
  a.entry.push_back({row, column, in.number("an entry's value")});
}

/// Per column "col j : locations a to b" and lines "row : value".
void read_columns(Words& in, TripletMatrix& a, int count) {
  for (int column = 0; column < a.columns; ++column) {
    in.expect("col");
    in.integer("the column's number", column, column);
    in.expect(":");
    in.expect("locations");
    const int begin = in.integer("the column's first location", 0, count);
    in.expect("to");
    const int last = in.integer("the column's last location", begin - 1, count - 1);
    for (int k = begin; k <= last; ++k) read_entry(in, a, column);
  }
}

/// As CSparse prints: "m-by-n, nzmax: .. nnz: .., 1-norm: .." and columns; or "triplet: m-by-n, nzmax: .. nnz: .." and
/// lines "row column : value".
void read_sparse(Words& in, TripletMatrix& a) {
  constexpr int kByRows = 3;
  const int kind = in.integer("the kind of sparse matrix", 0, kByRows);
  in.skip_line();  // version and copyright
  std::string_view size = in.word("the size of the sparse matrix");
  const bool triplets = size == "triplet:";
  if (triplets) size = in.word("the size of the sparse matrix");
  if (size != std::to_string(a.rows) + "-by-" + std::to_string(a.columns) + ",")
    in.fail("the sparse matrix is \"" + std::string(size) + "\", " + std::to_string(a.rows) + "-by-" +
            std::to_string(a.columns) + ", was announced");
  if (!triplets && kind == kByRows) in.fail("sparse matrices by rows have no text form; write triplets or columns");
  in.expect("nzmax:");
  in.integer("nzmax", 0, kMaxEntries);
  in.expect("nnz:");
  in.drop_comma();
  const int count = in.integer("the number of entries", 0, kMaxEntries);
  if (triplets) {
    for (int k = 0; k < count; ++k) read_entry(in, a, -1);
  } else {
    in.skip_line();  // the norm
    read_columns(in, a, count);
  }
}

TripletMatrix read_matrix(Words& in) {
  const int storage = in.integer("the storage of the matrix (0 dense, 1 blocks, 2 sparse)", 0, 2);
  TripletMatrix a;
  a.rows = in.integer("the number of rows", 1, kMaxRows);
  a.columns = in.integer("the number of columns", 1, kMaxRows);
  if (storage == 0) read_dense(in, a);
  if (storage == 1) read_sparse_blocks(in, a);
  if (storage == 2) read_sparse(in, a);
  return a;
}

bool is_matrix_of(const Words& in, int rows, int columns) {
  for (const int storage : {0, 1, 2})
    if (in.follows({storage, rows, columns})) return true;
  return false;
}

}  // namespace

LocalProblem read_siconos_text(const std::filesystem::path& path) {
  Words in(path);
  const int dimension = in.integer("the dimension", 2, 5);
  if (dimension == 4) in.fail("the dimension is 4; 2, 3 or 5 is needed");
  const int contacts = in.integer("the number of contacts", 1, kMaxRows / 5), rows = dimension * contacts;
  GlobalProblem problem;
  problem.dimension = dimension;
  problem.m = read_matrix(in);
  const bool global = is_matrix_of(in, problem.m.rows, rows);
  if (global) {
    problem.h = read_matrix(in);
    problem.f = in.numbers("f", problem.m.rows);
  } else if (problem.m.rows != rows || problem.m.columns != rows) {
    in.fail("W is " + std::to_string(problem.m.rows) + " x " + std::to_string(problem.m.columns) +
            "; dimension times contacts, " + std::to_string(rows) +
            ", is needed (or, behind M, a matrix H with as many columns)");
  }
  problem.w = in.numbers(global ? "w" : "q", rows);
  problem.mu = in.numbers("mu", contacts);
  if (dimension == 5) problem.mu_roll = in.numbers("mu_r", contacts);
  // Siconos ignores what follows, some of its files end with a flag; more numbers on the same line are a mistake.
  if (in.next_on_line_of_previous())
    in.fail("more friction coefficients than the " + std::to_string(contacts) + " contacts");
  if (global) return reduce_to_local(in.name(), problem);
  return make_problem(in.name(), dimension, problem.m.entry, problem.w, problem.mu, problem.mu_roll);
}

}  // namespace gonogo::sim
