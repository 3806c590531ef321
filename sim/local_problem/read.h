// Frictional contact problems from files.
//
//   HDF5 (FCLib):    /fclib_local          W, q, mu
//                    /fclib_global         M, H, f, w, mu           M v = H r + f, u = H^T v + w
//                    /fclib_global_rolling the same and mu_r, spacedim 5
//   text (Siconos):  dim, nc, matrix W, q, mu (, mu_r when dim is 5)
//                    dim, nc, matrices M and H, f, w, mu (, mu_r)
//
// Matrices: in HDF5 triplets (nz >= 0: rows i, columns p, or the reverse), compressed columns (nz = -1) or compressed
// rows (nz = -2); in text dense (0), sparse blocks (1) or sparse (2). Global problems are reduced to local form:
//   W = H^T M^-1 H,  q = w + H^T M^-1 f.
#pragma once
#include <filesystem>

#include "sim/local_problem/problem.h"

namespace gonogo::sim {

/// A sparse matrix as its files give it; equal positions are summed.
struct TripletMatrix {
  Index rows = 0, columns = 0;
  std::vector<Triplet> entry{};
};

struct GlobalProblem {
  int dimension = 3;
  TripletMatrix m{}, h{};               // [freedoms x freedoms], [freedoms x contact_count * dimension]
  std::vector<double> f{}, w{};         // [freedoms], [contact_count * dimension]
  std::vector<double> mu{}, mu_roll{};  // [contact_count]
};

/// Reads any of these formats, recognised by content. Throws InputError "file: place: value; expectation".
LocalProblem read_problem(const std::filesystem::path& path);

LocalProblem read_fclib(const std::filesystem::path& path);
LocalProblem read_siconos_text(const std::filesystem::path& path);

/// Throws InputError, starting with `name`, when sizes disagree or M is singular.
LocalProblem reduce_to_local(const std::string& name, const GlobalProblem& problem);

}  // namespace gonogo::sim
