// Models of outcomes: training, evaluation, answers, and their machines as annealing problems.
// Package component `learn`; link gonogo::outcome, and gonogo::train (LibTorch) to train and evaluate.
#pragma once
#include "base/error.h"
#include "pipeline/outcome/answer/infer.h"
#include "pipeline/outcome/answer/predictor.h"
#include "pipeline/outcome/evaluation/evaluate_model.h"
#include "pipeline/outcome/qubo/qubo_embed.h"
#include "pipeline/outcome/qubo/qubo_exchange.h"
#include "pipeline/outcome/sampling/rows_file.h"
#include "pipeline/outcome/sampling/sample_rows.h"
#include "pipeline/outcome/training/train_model.h"
