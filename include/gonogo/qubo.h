// Annealing problems: QUBO and Ising models, their file formats, samplers, qubit graphs and embeddings.
// Package component `learn`; link gonogo::learning and gonogo::hardware.
#pragma once
#include "base/error.h"
#include "learning/hardware/annealer_sampler.h"
#include "learning/hardware/embedding.h"
#include "learning/hardware/emulator.h"
#include "learning/hardware/graph.h"
#include "learning/qubo/format.h"
#include "learning/qubo/problem.h"
#include "learning/qubo/sample_set.h"
#include "learning/sampler/exact.h"
#include "learning/sampler/sampler.h"
