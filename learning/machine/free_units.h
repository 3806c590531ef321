// A machine of single units whose hidden units follow those of a machine of code words.
//
// Summed over its words, a machine of code words (word_machine.h) has
//
//   P(h) ~ exp(b.h + sum_g log sum_w exp(a_w + f_w.h)),     f_w the field of word w of group g.
//
// Samplers of single units cannot draw whole words. So free units, coupled with hidden units alone, stand for the
// words:
//
//   Q(h) ~ exp(b'.h + sum_k log(1 + exp(a'_k + W'_k.h))).
//
// Both exponents are convex in h. A group of two words is one free unit exactly. The others are fitted: a', b' and W'
// bring the difference of the exponents near a constant on rows of P and of Q. What is left is no error of answers,
// because a row of Q counts P(h) / Q(h), and its words are drawn given h.
#pragma once
#include <cstddef>

#include "learning/machine/word_machine.h"
#include "learning/model/weights.h"

namespace gonogo::learning {

/// Q with `count` free units as visible ones; the hidden units are those of `machine`. Deterministic, on one thread.
RbmWeights fitted_free_units(const WordMachine& machine, std::size_t count);

}  // namespace gonogo::learning
