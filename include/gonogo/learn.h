// Models of outcomes: training, evaluation, answers, and their machines as annealing problems.
// Package component `learn`; link gonogo::learn, and gonogo::train (LibTorch) to train and evaluate.
#pragma once
#include "base/error.h"
#include "pipeline/learn/answer/infer.h"
#include "pipeline/learn/answer/predictor.h"
#include "pipeline/learn/evaluation/evaluate_model.h"
#include "pipeline/learn/qubo/qubo_embed.h"
#include "pipeline/learn/qubo/qubo_exchange.h"
#include "pipeline/learn/sampling/sample_rows.h"
#include "pipeline/learn/training/train_model.h"
