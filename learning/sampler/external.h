// Rows that come from outside: from a file that somebody puts there, or from a program.
#pragma once
#include "learning/sampler/sampler.h"

namespace gonogo::learning {

/// Problems go to <folder>/<hash>.json (dimod's JSON, with a sidecar), answers are taken from
/// <folder>/<hash>.answer.json (dimod's SampleSet). Where the answer is missing, the problem is written and InputError
/// says what is awaited: the same command goes on once the answer is there. The seed and the number of reads are part
/// of the hash, so that two requests for one problem are two files.
class FileSampler final : public Sampler {
 public:
  explicit FileSampler(const SamplerSettings& settings) : settings_(settings) {}
  std::string name() const override { return "file"; }
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override;

 private:
  SamplerSettings settings_;
};

/// Runs a program that reads {problem} (dimod's JSON) and writes {answer} (dimod's SampleSet). The answer is read only
/// after the program ended with status 0 within the time limit, and must hold as many reads as asked for; otherwise
/// InputError with the end of its stderr.
class CommandSampler final : public Sampler {
 public:
  explicit CommandSampler(const SamplerSettings& settings);
  std::string name() const override { return "command"; }
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override;

 private:
  SamplerSettings settings_;
};

/// One row per read instead of counts; throws InputError unless there are `reads` of them. `source` starts the message.
SampleSet spread_reads(const SampleSet& answer, std::size_t reads, const std::string& source);

}  // namespace gonogo::learning
