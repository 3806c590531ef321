#include <charconv>
#include <cmath>
#include <string_view>

#include "base/error.h"
#include "base/file.h"
#include "sim/local_problem/read.h"

namespace gonogo::sim {
namespace {

/// The words of a text file, with the line each stands on.
class Words {
 public:
  explicit Words(const std::filesystem::path& path) : name_(path.string()), content_(read_file(path)) {
    int line = 1;
    for (std::size_t at = 0; at < content_.size();) {
      const char c = content_[at];
      line += c == '\n';
      if (is_space(c)) {
        ++at;
        continue;
      }
      std::size_t end = at;
      while (end < content_.size() && !is_space(content_[end])) ++end;
      word_.push_back({std::string_view(content_).substr(at, end - at), line});
      at = end;
    }
  }

  const std::string& name() const { return name_; }
  std::size_t left() const { return word_.size() - next_; }
  int line() const { return next_ < word_.size() ? word_[next_].line : word_.empty() ? 1 : word_.back().line; }

  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(name_ + ": line " + std::to_string(line()) + ": " + message);
  }

  std::string_view word(const std::string& what) {
    if (next_ >= word_.size()) fail("the file ends where " + what + " is needed; it is cut off or another format");
    return word_[next_++].text;
  }

  int integer(const std::string& what, int low, int high) {
    int value = 0;
    const std::string_view text = word(what);
    if (!parse(text, value) || value < low || value > high) {
      --next_;
      fail(what + " is \"" + std::string(text) + "\"; an integer from " + std::to_string(low) + " to " +
           std::to_string(high) + " is needed");
    }
    return value;
  }

  double number(const std::string& what) {
    double value = 0;
    const std::string_view text = word(what);
    if (!parse(text, value) || !std::isfinite(value)) {
      --next_;
      fail(what + " is \"" + std::string(text) + "\"; a finite number is needed");
    }
    return value;
  }

  std::vector<double> numbers(const std::string& what, int count) {
    require_left(what, count);
    std::vector<double> values;
    for (int i = 0; i < count; ++i) values.push_back(number(what + "[" + std::to_string(i) + "]"));
    return values;
  }

  void require_left(const std::string& what, double count) const {
    if (double(left()) < count)
      fail(what + " needs " + std::to_string(std::int64_t(count)) + " values, the file has only " +
           std::to_string(left()) + " more");
  }

  void expect(const std::string& text) {
    const std::string_view found = word("\"" + text + "\"");
    if (found != text) {
      --next_;
      fail("\"" + std::string(found) + "\" stands where \"" + text + "\" is needed");
    }
  }

  void skip_line() {
    for (const int here = line(); next_ < word_.size() && word_[next_].line == here;) ++next_;
  }

  /// Whether the next words are these integers.
  bool follows(const std::vector<int>& values) const {
    if (left() < values.size()) return false;
    for (std::size_t i = 0; i < values.size(); ++i) {
      int value = 0;
      if (!parse(word_[next_ + i].text, value) || value != values[i]) return false;
    }
    return true;
  }

  bool next_on_line_of_previous() const {
    return next_ > 0 && next_ < word_.size() && word_[next_].line == word_[next_ - 1].line;
  }

 private:
  struct Word {
    std::string_view text;
    int line;
  };
  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }
  template <class T>
  static bool parse(std::string_view text, T& value) {
    if (!text.empty() && text[0] == '+') text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size();
  }

  std::string name_, content_;
  std::vector<Word> word_;
  std::size_t next_ = 0;
};

constexpr int kMostRows = 10'000'000;

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
  const int blocks = in.integer("the number of blocks", 1, kMostRows);
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

/// As CSparse prints: "m-by-n, nzmax: .. nnz: .., 1-norm: .." and per column "col j : locations a to b" and lines
/// "row : value"; or "triplet: m-by-n, nzmax: .. nnz: .." and lines "row column : value".
void read_sparse(Words& in, TripletMatrix& a) {
  const int origin = in.integer("the kind of sparse matrix", 0, 3);
  in.skip_line();  // version and copyright
  std::string_view size = in.word("the size of the sparse matrix");
  const bool triplets = size == "triplet:";
  if (triplets) size = in.word("the size of the sparse matrix");
  if (size != std::to_string(a.rows) + "-by-" + std::to_string(a.columns) + ",")
    in.fail("the sparse matrix is \"" + std::string(size) + "\", " + std::to_string(a.rows) + "-by-" +
            std::to_string(a.columns) + ", was announced");
  if (!triplets && origin == 3) in.fail("sparse matrices by rows have no text form; write triplets or columns");
  in.expect("nzmax:");
  in.integer("nzmax", 0, kMostRows);
  in.expect("nnz:");
  const std::string_view count_text = in.word("the number of entries");
  int count = 0;
  std::from_chars(count_text.data(), count_text.data() + count_text.size(), count);
  const auto row = [&] { return in.integer("an entry's row", 0, a.rows - 1); };
  const auto value = [&] {
    in.expect(":");
    return in.number("an entry's value");
  };
  if (triplets) {
    for (int k = 0; k < count; ++k) {
      const int r = row(), c = in.integer("an entry's column", 0, a.columns - 1);
      a.entry.push_back({r, c, value()});
    }
    return;
  }
  in.skip_line();  // the norm
  for (int column = 0; column < a.columns; ++column) {
    in.expect("col");
    in.integer("the column's number", column, column);
    in.expect(":");
    in.expect("locations");
    const int begin = in.integer("the column's first location", 0, count);
    in.expect("to");
    const int last = in.integer("the column's last location", begin - 1, count - 1);
    for (int k = begin; k <= last; ++k) {
      const int r = row();
      a.entry.push_back({r, column, value()});
    }
  }
}

TripletMatrix read_matrix(Words& in) {
  const int storage = in.integer("the storage of the matrix (0 dense, 1 blocks, 2 sparse)", 0, 2);
  TripletMatrix a;
  a.rows = in.integer("the number of rows", 1, kMostRows);
  a.columns = in.integer("the number of columns", 1, kMostRows);
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
  const int contacts = in.integer("the number of contacts", 1, kMostRows / 5), rows = dimension * contacts;
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
