// A local problem with a random matrix of given rank.
#pragma once
#include <Eigen/Dense>
#include <random>
#include <vector>

#include "sim/local_problem/read.h"

namespace gonogo::sim {

/// W = H^T H with H [freedoms x dimension contacts] of normal numbers. q: normal, less `push` [m/s] along the normals.
/// Every contact has this friction, and rolling friction of the same number where the dimension is 5.
inline LocalProblem random_problem(unsigned seed, int dimension, int contacts, int freedoms, double push,
                                   double friction) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  const int size = dimension * contacts;
  Eigen::MatrixXd h(freedoms, size);
  for (int i = 0; i < freedoms; ++i)
    for (int j = 0; j < size; ++j) h(i, j) = normal(generator);
  const Eigen::MatrixXd w = h.transpose() * h;
  std::vector<Triplet> entry;
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j) entry.push_back({i, j, w(i, j)});
  std::vector<double> q;
  for (int i = 0; i < size; ++i) q.push_back(normal(generator) - (i % dimension == 0 ? push : 0));
  const std::vector<double> mu(std::size_t(contacts), friction);
  return make_problem("random", dimension, entry, q, mu, dimension == 5 ? mu : std::vector<double>{});
}

}  // namespace gonogo::sim
