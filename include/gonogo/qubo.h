// Annealing problems: QUBO and Ising models, their file formats, samplers, qubit graphs and embeddings.
// Package component `learn`; link gonogo::learning and gonogo::hardware.
#pragma once
#include "base/error.h"
#include "learning/annealer/annealer_sampler.h"
#include "learning/annealer/emulator.h"
#include "learning/formats/format.h"
#include "learning/qubits/embedding.h"
#include "learning/qubits/graph.h"
#include "learning/qubits/line_embedding.h"
#include "learning/qubo/problem.h"
#include "learning/qubo/sample_set.h"
#include "learning/sampler/exact.h"
#include "learning/sampler/sampler.h"
