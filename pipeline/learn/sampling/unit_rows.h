// Rows of a machine's joint distribution by samplers of single units, as an annealer draws them.
#pragma once
#include "learning/sampler/word_machine.h"
#include "pipeline/learn/sampling/sample_rows.h"

namespace gonogo::learn {

/// Least share of the reads that their weights may be worth.
inline constexpr double kMinWorth = 0.05;

/// Words of `request.rows` rows: [row][group] of the machine with what is known clamped. The hidden units of every read
/// give the words. block_gibbs and emulator sample the machine as it is: reads are weighed for the words that are no
/// code words, and drawn again by their weights. anneal and population sample it with a penalty of 8 on such words.
/// Throws InputError where the weights leave fewer than kMinWorth of the reads.
std::vector<std::vector<std::uint16_t>> unit_rows(const learning::Model& model, const learning::KnownPart& known,
                                                  const RowRequest& request);

}  // namespace gonogo::learn
