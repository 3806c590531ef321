// Readers of local problems: the same small problem in every layout, files by others against sums made another way, and
// refusals.
#include <Eigen/Dense>
#include <cmath>
#include <functional>

#include "base/files/file.h"
#include "base/hdf5/hdf5.h"
#include "base/json/json.h"
#include "sim/local_problem/read.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::sim;

namespace {

const std::filesystem::path kTests = std::filesystem::path(GONOGO_SOURCE_DIR) / "tests";

// Two contacts in the plane; unlike its transpose, with an empty block.
const std::vector<Triplet> kW = {{0, 0, 2},   {0, 1, 0.5}, {1, 0, 0.25}, {1, 1, 3},
                                 {0, 2, -1.}, {1, 3, 7},   {2, 2, 4},    {3, 3, 5}};
const std::vector<double> kQ = {1, -2, 3, -4}, kMu = {0.5, 0.75};

void put_scalar(Hdf5Writer& out, const std::string& path, int value) {
  out.array(path, std::vector<std::int32_t>{value});
}

void put_matrix(Hdf5Writer& out, const std::string& group, int rows, int columns, int kind,
                const std::vector<Triplet>& entries) {
  std::vector<std::int32_t> p, i;
  std::vector<double> x;
  if (kind >= 0) {
    for (const Triplet& t : entries) {
      p.push_back(t.column);
      i.push_back(t.row);
      x.push_back(t.value);
    }
  } else {
    for (int line = 0; line < (kind == -1 ? columns : rows); ++line) {
      p.push_back(int(x.size()));
      for (const Triplet& t : entries)
        if ((kind == -1 ? t.column : t.row) == line) {
          i.push_back(kind == -1 ? t.row : t.column);
          x.push_back(t.value);
        }
    }
    p.push_back(int(x.size()));
  }
  put_scalar(out, group + "/m", rows);
  put_scalar(out, group + "/n", columns);
  put_scalar(out, group + "/nz", kind >= 0 ? int(entries.size()) : kind);
  put_scalar(out, group + "/nzmax", int(entries.size()));
  out.array(group + "/p", p);
  out.array(group + "/i", i);
  out.array(group + "/x", x);
}

Hdf5Writer local_file(int kind) {
  Hdf5Writer out;
  put_scalar(out, "fclib_local/spacedim", 2);
  put_matrix(out, "fclib_local/W", 4, 4, kind, kW);
  out.array("fclib_local/vectors/q", kQ);
  out.array("fclib_local/vectors/mu", kMu);
  return out;
}

const std::string kTail = "1 -2 3 -4\n0.5 0.75\n";
const std::string kDense = "2\n2\n0\n4\n4\n4\t4\n2 0.25 0 0\n0.5 3 0 0\n-1 0 4 0\n0 7 0 5\n";
const std::string kBlocks =
    "2\n2\n1\n4\n4\n3\n2\n2\n2\t4\n2\t4\n3\n3\n0\t2\t3\n0\t1\t1\n0\n2\n0.25\n0.5\n3\n1\n-1\n0\n0\n7\n2\n4\n0\n0\n5\n";
const std::string kTriplets =
    "2\n2\n2\n4\n4\n1\nCSparse Version 3.2.0, Sept 12, 2017.  Copyright (c)\ntriplet: 4-by-4, nzmax: 8 nnz: 8\n"
    "    0 0 : 2\n    0 1 : 0.5\n    1 0 : 0.25\n    1 1 : 3\n    0 2 : -1\n    1 3 : 7\n    2 2 : 4\n    3 3 : 5\n";
const std::string kColumns =
    "2\n2\n2\n4\n4\n2\nCSparse Version 3.2.0, Sept 12, 2017.  Copyright (c)\n4-by-4, nzmax: 8 nnz: 8, 1-norm: 12\n"
    "    col 0 : locations 0 to 1\n      0 : 2\n      1 : 0.25\n    col 1 : locations 2 to 3\n      0 : 0.5\n      1 : "
    "3\n"
    "    col 2 : locations 4 to 5\n      0 : -1\n      2 : 4\n    col 3 : locations 6 to 7\n      1 : 7\n      3 : 5\n";

void check_is_ours(const LocalProblem& p) {
  CHECK(p.dimension == 2);
  CHECK(p.q == kQ);
  CHECK(p.mu == kMu);
  CHECK(p.w.first == std::vector<Index>{0, 2, 3});
  CHECK(p.w.column == std::vector<Index>{0, 1, 1});
  CHECK(p.w.value == std::vector<double>{2, 0.5, 0.25, 3, -1, 0, 0, 7, 4, 0, 0, 5});
}

struct Files {
  TemporaryFolder folder;
  LocalProblem text(const std::string& content) const {
    write_file_atomically(folder / "p.dat", content);
    return read_problem(folder / "p.dat");
  }
  LocalProblem hdf5(const Hdf5Writer& content) const {
    content.save(folder / "p.hdf5");
    return read_problem(folder / "p.hdf5");
  }
};

double weighted_sum(const LocalProblem& p) {
  double sum = 0;
  const int d = p.dimension;
  for (Index i = 0; i < p.contact_count(); ++i)
    for (Index k = p.w.first[i]; k < p.w.first[i + 1]; ++k)
      for (int a = 0; a < d; ++a)
        for (int b = 0; b < d; ++b)
          sum += (i * d + a + 1) * std::cos(double(p.w.column[k] * d + b)) *
                 p.w.value[std::size_t(k) * d * d + std::size_t(a) * d + b];
  return sum;
}

}  // namespace

TEST_CASE("one problem in every layout of FCLib and Siconos reads the same") {
  const Files files;
  for (const int kind : {0, -1, -2}) check_is_ours(files.hdf5(local_file(kind)));
  for (const std::string& matrix : {kDense, kBlocks, kTriplets, kColumns}) {
    check_is_ours(files.text(matrix + kTail));
    check_is_ours(files.text(matrix + kTail + "1\n"));  // Siconos files may end with a flag
  }
}

TEST_CASE("a global problem becomes W = H^T M^-1 H and q = w + H^T M^-1 f, as a dense elimination finds") {
  const int freedoms = 7, contacts = 2, reactions = 3 * contacts;
  Eigen::MatrixXd m = Eigen::MatrixXd::Identity(freedoms, freedoms) * 3, h(freedoms, reactions);
  for (int i = 0; i < freedoms; ++i)
    for (int j = 0; j < reactions; ++j) h(i, j) = std::sin(1 + 3.0 * i + j * j);
  m(0, 3) = m(3, 0) = 1;
  m(5, 6) = 0.5;
  const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(freedoms, -1, 2),
                        w = Eigen::VectorXd::LinSpaced(reactions, 3, 4);
  const Eigen::MatrixXd expected_w = h.transpose() * m.fullPivLu().solve(h);
  const Eigen::VectorXd expected_q = w + h.transpose() * m.fullPivLu().solve(f);
  const auto triplets = [](const Eigen::MatrixXd& a) {
    std::vector<Triplet> entry;
    for (Index i = 0; i < a.rows(); ++i)
      for (Index j = 0; j < a.cols(); ++j)
        if (a(i, j) != 0) entry.push_back({i, j, a(i, j)});
    return entry;
  };
  const auto dense = [](const Eigen::MatrixXd& a) {
    std::string text = "0\n" + std::to_string(a.rows()) + "\n" + std::to_string(a.cols()) + "\n" +
                       std::to_string(a.rows()) + "\t" + std::to_string(a.cols()) + "\n";
    for (const double x : a.reshaped()) text += Json(x).dump() + " ";
    return text + "\n";
  };
  Hdf5Writer out;
  put_scalar(out, "fclib_global/spacedim", 3);
  put_matrix(out, "fclib_global/M", freedoms, freedoms, 0, triplets(m));
  put_matrix(out, "fclib_global/H", freedoms, reactions, -1, triplets(h));
  out.array("fclib_global/vectors/f", std::vector<double>(f.begin(), f.end()));
  out.array("fclib_global/vectors/w", std::vector<double>(w.begin(), w.end()));
  out.array("fclib_global/vectors/mu", std::vector<double>{0.1, 0.2});
  std::string text = "3\n2\n" + dense(m) + dense(h);
  for (const double x : f) text += Json(x).dump() + " ";
  for (const double x : w) text += Json(x).dump() + " ";
  const Files files;
  for (const LocalProblem& p : {files.hdf5(out), files.text(text + "\n0.1 0.2\n")}) {
    CHECK(p.mu == std::vector<double>{0.1, 0.2});
    for (int i = 0; i < reactions; ++i) CHECK(p.q[i] == Approx(expected_q[i]).epsilon(1e-13));
    for (int row = 0; row < reactions; ++row)
      for (int column = 0; column < reactions; ++column)
        CHECK(p.w.value[std::size_t((row / 3 * 2 + column / 3) * 9 + row % 3 * 3 + column % 3)] ==
              Approx(expected_w(row, column)).epsilon(1e-12));
  }
}

TEST_CASE("triplets with rows in p, as fclib.h documents, and in i, as Siconos writes, give the same H") {
  const std::vector<Triplet> h = {{0, 0, 1}, {3, 1, 2}, {4, 0, 3}},
                             mass = {{0, 0, 1}, {1, 1, 1}, {2, 2, 1}, {3, 3, 2}, {4, 4, 4}};
  const Files files;
  for (const bool documented : {false, true}) {
    Hdf5Writer out;
    put_scalar(out, "fclib_global/spacedim", 2);
    put_matrix(out, "fclib_global/M", 5, 5, 0, mass);
    std::vector<Triplet> stored = h;
    for (Triplet& t : stored)
      if (documented) std::swap(t.row, t.column);
    put_matrix(out, "fclib_global/H", 5, 2, 0, stored);
    out.array("fclib_global/vectors/f", std::vector<double>(5, 0.0));
    out.array("fclib_global/vectors/w", std::vector<double>{-1, 0});
    out.array("fclib_global/vectors/mu", std::vector<double>{0.5});
    CHECK(files.hdf5(out).w.value == std::vector<double>{1 + 9. / 4, 0, 0, 2});
  }
}

TEST_CASE("every problem by others reads as h5dump and a plain parser read it") {
  const Json golden = Json::read(kTests / "golden/fclib/problems.json");
  CHECK(golden.members().size() == 11);
  for (const auto& [name, sums] : golden.members()) {
    INFO(name);
    const LocalProblem p = read_problem(kTests / "data/fclib" / name);
    CHECK(p.dimension == sums.at("dimension").integer());
    CHECK(p.contact_count() == sums.at("contacts").integer());
    double trace = 0, weighted_q = 0, square_q = 0, mu = 0, mu_roll = 0;
    for (Index i = 0; i < p.contact_count(); ++i)
      for (int a = 0; a < p.dimension; ++a) trace += p.diagonal_block(i)[a * (p.dimension + 1)];
    for (std::size_t i = 0; i < p.q.size(); ++i) {
      weighted_q += double(i + 1) * p.q[i];
      square_q += p.q[i] * p.q[i];
    }
    for (const double x : p.mu) mu += x;
    for (const double x : p.mu_roll) mu_roll += x;
    CHECK(trace == Approx(sums.at("trace_w").number()).epsilon(1e-10));
    CHECK(weighted_sum(p) == Approx(sums.at("weighted_w").number()).epsilon(1e-8));
    CHECK(weighted_q == Approx(sums.at("weighted_q").number()).epsilon(1e-8));
    CHECK(std::sqrt(square_q) == Approx(sums.at("length_q").number()).epsilon(1e-10));
    CHECK(mu == Approx(sums.at("sum_mu").number()).epsilon(1e-12));
    CHECK(mu_roll == Approx(sums.at("sum_mu_r").number()).epsilon(1e-12));
  }
}

TEST_CASE("malformed text is refused with file, line, value and expectation") {
  const Files files;
  const auto text = [&](const std::string& content) { return [&files, content] { files.text(content); }; };
  refused([&] { read_problem(files.folder / "none.dat"); }, "none.dat");
  refused(text(""), "p.dat: line 1: the file ends where the dimension is needed");
  refused(text("4\n2\n"), "the dimension is 4; 2, 3 or 5");
  refused(text("2\nmany\n"), "line 2: the number of contacts is \"many\"; an integer from 1 to");
  refused(text("2\n2\n7\n"), "the storage of the matrix (0 dense, 1 blocks, 2 sparse) is \"7\"");
  refused(text(kDense), "q needs 4 values, the file has only 0 more");
  refused(text(kDense + "1 -2 x -4\n0.5 0.75\n"), "line 11: q[2] is \"x\"; a finite number is needed");
  refused(text(kDense + "1 -2 nan -4\n0.5 0.75\n"), "q[2] is \"nan\"");
  refused(text(kDense + "1 -2 3 -4\n0.5\n"), "mu needs 2 values");
  refused(text(kDense + "1 -2 3 -4\n0.5 0.75 0.8\n"), "more friction coefficients than the 2 contacts");
  refused(text("2\n3\n" + kDense.substr(4) + kTail), "W is 4 x 4; dimension times contacts, 6, is needed");
  std::string blocks = kBlocks;
  blocks.replace(blocks.find("0\t1\t1\n"), 6, "0\t2\t1\n");
  refused(text(blocks + kTail), "a block's column is \"2\"; an integer from 0 to 1");
  std::string columns = kColumns;
  columns.replace(columns.find("4-by-4"), 6, "4-by-5");
  refused(text(columns + kTail), "the sparse matrix is \"4-by-5,\", 4-by-4, was announced");
}

TEST_CASE("malformed HDF5 is refused with file, place, value and expectation") {
  const Files files;
  const auto with = [&](const std::function<void(Hdf5Writer&)>& fill) {
    return [&files, fill] {
      Hdf5Writer out;
      fill(out);
      files.hdf5(out);
    };
  };
  refused(with([](Hdf5Writer&) {}), "p.hdf5: /: none of fclib_local, fclib_global, fclib_global_rolling");
  refused(with([](Hdf5Writer& out) {
            put_scalar(out, "fclib_local/spacedim", 2);
            put_matrix(out, "fclib_local/V", 4, 1, 0, {{0, 0, 1}});
          }),
          "fclib_local/V: bilateral rows are not supported");
  refused(with([](Hdf5Writer& out) {
            put_matrix(out, "fclib_local/W", 4, 4, 0, {{4, 0, 1}});
          }),
          "fclib_local/W: entry 0 is at (4, 0), outside 4 x 4");
  refused(with([](Hdf5Writer& out) {
            put_matrix(out, "fclib_local/W", 4, 3, 0, {});
            out.array("fclib_local/vectors/q", kQ);
          }),
          "fclib_local/W: is 4 x 3; q has 4 values");
  refused(with([](Hdf5Writer& out) {
            put_matrix(out, "fclib_local/W", 4, 4, -2, {});
            out.array("fclib_local/vectors/q", std::vector<float>{1, 2});
          }),
          "fclib_local/vectors/q: holds 32-bit numbers, 64-bit numbers are needed");
  refused(with([](Hdf5Writer& out) {
            for (const auto& [name, value] : {std::pair("m", 1), {"n", 1}, {"nz", -1}})
              put_scalar(out, std::string("fclib_local/W/") + name, value);
            out.array("fclib_local/W/p", std::vector<std::int32_t>{0, -1});
            out.array("fclib_local/W/i", std::vector<std::int32_t>{0});
            out.array("fclib_local/W/x", std::vector<double>{1});
          }),
          "fclib_local/W/p: decreases from 0 to -1");
}
