#include "sim/local_problem/read.h"

#include <Eigen/SparseLU>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/files/file.h"
#include "base/hdf5/hdf5.h"

namespace gonogo::sim {
namespace {

/// The words of a text file and their lines.
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

  /// Takes a trailing comma off the next word.
  void drop_comma() {
    if (next_ < word_.size() && word_[next_].text.back() == ',') word_[next_].text.remove_suffix(1);
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

int integer(const Hdf5Reader& file, const std::string& place) {
  const auto values = file.array<std::int32_t>(place);
  if (values.size() != 1) file.fail(place, "holds " + std::to_string(values.size()) + " values, one is needed");
  return values[0];
}

/// The arrays of one stored matrix.
struct Stored {
  const Hdf5Reader& file;
  std::string place;
  int rows, columns, kind;  // kind: nz of the format
  std::vector<std::int32_t> p, i;
  std::vector<double> x;

  Stored(const Hdf5Reader& reader, const std::string& group)
      : file(reader),
        place(group),
        rows(integer(reader, group + "/m")),
        columns(integer(reader, group + "/n")),
        kind(integer(reader, group + "/nz")),
        p(reader.array<std::int32_t>(group + "/p")),
        i(reader.array<std::int32_t>(group + "/i")),
        x(reader.array<double>(group + "/x")) {
    if (rows < 1 || columns < 1)
      file.fail(place, "is " + std::to_string(rows) + " x " + std::to_string(columns) + "; both must be positive");
    if (kind < -2) file.fail(place + "/nz", "= " + std::to_string(kind) + "; -2, -1 or a count is needed");
  }

  void require(const std::string& array, std::size_t length, std::size_t needed) const {
    if (length < needed)
      file.fail(place + "/" + array,
                "holds " + std::to_string(length) + " values, at least " + std::to_string(needed) + " are needed");
  }

  void add(TripletMatrix& matrix, int row, int column, std::size_t at) const {
    if (row < 0 || row >= rows || column < 0 || column >= columns)
      file.fail(place, "entry " + std::to_string(at) + " is at (" + std::to_string(row) + ", " +
                           std::to_string(column) + "), outside " + std::to_string(rows) + " x " +
                           std::to_string(columns));
    matrix.entry.push_back({row, column, x[at]});
  }

  /// Whether the first `count` of `rows_of` and of `columns_of` fit the matrix as rows and columns.
  bool fit(const std::vector<std::int32_t>& rows_of, const std::vector<std::int32_t>& columns_of, int count) const {
    for (int at = 0; at < count; ++at)
      if (rows_of[at] < 0 || rows_of[at] >= rows || columns_of[at] < 0 || columns_of[at] >= columns) return false;
    return true;
  }

  /// fclib.h says that p holds rows and i columns; the files that Siconos writes have them the other way (as CSparse
  /// does). The one that fits the matrix is meant; where both do (W and M are symmetric), that of the files.
  void add_triplets(TripletMatrix& matrix) const {
    for (const auto& [name, length] : {std::pair("p", p.size()), {"i", i.size()}, {"x", x.size()}})
      require(name, length, std::size_t(kind));
    const bool as_documented = !fit(i, p, kind) && fit(p, i, kind);
    for (int at = 0; at < kind; ++at) as_documented ? add(matrix, p[at], i[at], at) : add(matrix, i[at], p[at], at);
  }

  /// Lines are columns for kind -1, rows for kind -2.
  void add_compressed(TripletMatrix& matrix) const {
    const int lines = kind == -1 ? columns : rows;
    require("p", p.size(), std::size_t(lines) + 1);
    if (p[0] != 0) file.fail(place + "/p", "starts with " + std::to_string(p[0]) + "; 0 is needed");
    for (int line = 0; line < lines; ++line) {
      if (p[line + 1] < p[line])
        file.fail(place + "/p", "decreases from " + std::to_string(p[line]) + " to " + std::to_string(p[line + 1]));
      require("i", i.size(), std::size_t(p[line + 1]));
      require("x", x.size(), std::size_t(p[line + 1]));
      for (int at = p[line]; at < p[line + 1]; ++at)
        kind == -1 ? add(matrix, i[at], line, at) : add(matrix, line, i[at], at);
    }
  }
};

TripletMatrix read_matrix(const Hdf5Reader& file, const std::string& place) {
  const Stored stored(file, place);
  TripletMatrix matrix{stored.rows, stored.columns, {}};
  stored.kind >= 0 ? stored.add_triplets(matrix) : stored.add_compressed(matrix);
  return matrix;
}

void refuse_equalities(const Hdf5Reader& file, const std::string& group, std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (file.has(group + "/" + name))
      file.fail(group + "/" + name, "bilateral rows are not supported; give a problem of contacts only");
}

LocalProblem read_local(const Hdf5Reader& file) {
  const std::string group = "fclib_local", name = file.path().string();
  refuse_equalities(file, group, {"V", "R"});
  const TripletMatrix w = read_matrix(file, group + "/W");
  auto q = file.array<double>(group + "/vectors/q");
  if (w.rows != w.columns || std::size_t(w.rows) != q.size())
    file.fail(group + "/W", "is " + std::to_string(w.rows) + " x " + std::to_string(w.columns) + "; q has " +
                                std::to_string(q.size()) + " values, W must be square of that size");
  return make_problem(name, integer(file, group + "/spacedim"), w.entry, std::move(q),
                      file.array<double>(group + "/vectors/mu"));
}

LocalProblem read_global(const Hdf5Reader& file, const std::string& group) {
  refuse_equalities(file, group, {"G"});
  GlobalProblem problem;
  problem.dimension = integer(file, group + "/spacedim");
  problem.m = read_matrix(file, group + "/M");
  problem.h = read_matrix(file, group + "/H");
  problem.f = file.array<double>(group + "/vectors/f");
  problem.w = file.array<double>(group + "/vectors/w");
  problem.mu = file.array<double>(group + "/vectors/mu");
  if (file.has(group + "/vectors/mu_r")) problem.mu_roll = file.array<double>(group + "/vectors/mu_r");
  return reduce_to_local(file.path().string(), problem);
}

}  // namespace

LocalProblem read_fclib(const std::filesystem::path& path) {
  const Hdf5Reader file(path);
  if (file.has("fclib_local")) return read_local(file);
  for (const std::string group : {"fclib_global", "fclib_global_rolling"})
    if (file.has(group)) return read_global(file, group);
  file.fail("", "none of fclib_local, fclib_global, fclib_global_rolling is here; an FCLib file has one of them");
}

LocalProblem read_problem(const std::filesystem::path& path) {
  const std::string magic = "\x89HDF\r\n\x1a\n";
  const std::string content = read_file(path);
  return content.substr(0, magic.size()) == magic ? read_fclib(path) : read_siconos_text(path);
}

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
  TripletMatrix a{.rows = in.integer("the number of rows", 1, kMaxRows),
                  .columns = in.integer("the number of columns", 1, kMaxRows)};
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
  GlobalProblem problem{.dimension = dimension, .m = read_matrix(in)};
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

namespace {

using Sparse = Eigen::SparseMatrix<double>;

Sparse to_eigen(const std::string& name, const char* what, const TripletMatrix& a) {
  std::vector<Eigen::Triplet<double>> entry;
  for (const Triplet& t : a.entry) {
    if (!std::isfinite(t.value))
      throw InputError(name + ": " + what + "(" + std::to_string(t.row) + ", " + std::to_string(t.column) +
                       ") is not a finite number");
    entry.emplace_back(t.row, t.column, t.value);
  }
  Sparse matrix(a.rows, a.columns);
  matrix.setFromTriplets(entry.begin(), entry.end());
  return matrix;
}

void require_sizes(const std::string& name, const GlobalProblem& p) {
  const auto require = [&](const std::string& what, std::size_t found, std::size_t needed) {
    if (found != needed)
      throw InputError(name + ": " + what + " is " + std::to_string(found) + "; " + std::to_string(needed) +
                       " is needed");
  };
  require("the number of columns of M", std::size_t(p.m.columns), std::size_t(p.m.rows));
  require("the number of rows of H", std::size_t(p.h.rows), std::size_t(p.m.rows));
  require("the number of columns of H", std::size_t(p.h.columns), p.mu.size() * std::size_t(p.dimension));
  require("the length of f", p.f.size(), std::size_t(p.m.rows));
  require("the length of w", p.w.size(), std::size_t(p.h.columns));
}

}  // namespace

LocalProblem reduce_to_local(const std::string& name, const GlobalProblem& problem) {
  require_sizes(name, problem);
  const Sparse m = to_eigen(name, "M", problem.m), h = to_eigen(name, "H", problem.h);
  Eigen::SparseLU<Sparse> lu(m);
  if (lu.info() != Eigen::Success)
    throw InputError(name + ": M is singular (" + lu.lastErrorMessage() + "); every freedom needs a mass");
  const Eigen::Map<const Eigen::VectorXd> f(problem.f.data(), Eigen::Index(problem.f.size()));
  const Eigen::VectorXd free_velocity = lu.solve(f);
  const Sparse w = (h.transpose() * Sparse(lu.solve(h))).pruned(1.0, 0.0);
  std::vector<Triplet> entry;
  for (Eigen::Index column = 0; column < w.cols(); ++column)
    for (Sparse::InnerIterator it(w, column); it; ++it) entry.push_back({Index(it.row()), Index(column), it.value()});
  Eigen::VectorXd q = Eigen::Map<const Eigen::VectorXd>(problem.w.data(), Eigen::Index(problem.w.size()));
  q += h.transpose() * free_velocity;
  return make_problem(name, problem.dimension, entry, std::vector<double>(q.begin(), q.end()), problem.mu,
                      problem.mu_roll);
}

}  // namespace gonogo::sim
