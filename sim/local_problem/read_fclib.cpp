#include <initializer_list>

#include "base/error.h"
#include "base/file.h"
#include "base/hdf5/hdf5.h"
#include "sim/local_problem/read.h"

namespace gonogo::sim {
namespace {

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

}  // namespace gonogo::sim
