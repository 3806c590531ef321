// Newton's systems of an interior point by conjugate gradients. The matrix A = W + C is scaled so that the blocks of
// the contacts on its diagonal are 1. An inverse of that as a tensor train preconditions it, after Corona, Gorsich,
// Jayakumar & Veerapaneni (2019): one inverse serves as long as conjugate gradients stay few, and the next one starts
// from it. An inverse that the rank limit spoils is not used. Inside sim/local_problem.
#pragma once
#include "sim/local_problem/newton_system.h"

namespace gonogo::sim {

/// For symmetric W. `by_tensor_train`: false for the scaling alone.
std::unique_ptr<NewtonSystem> make_block_system(int dimension, bool by_tensor_train);

}  // namespace gonogo::sim
