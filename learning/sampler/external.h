// Rows from outside: from a file that a person provides, or from another program.
#pragma once
#include "learning/sampler/sampler.h"

namespace gonogo::learning {

/// Writes problems to <folder>/<hash>.json (dimod's JSON, with a sidecar) and reads answers from
/// <folder>/<hash>.answer.json (dimod's SampleSet). When the answer is missing, InputError names it; the same command
/// continues once the file exists. The hash covers seed and number of reads, so that each request has its own file.
class FileSampler final : public Sampler {
 public:
  explicit FileSampler(const SamplerSettings& settings) : settings_(settings) {}
  std::string name() const override { return "file"; }
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override;

 private:
  SamplerSettings settings_;
};

/// Runs a program that reads {problem} (dimod's JSON) and writes {answer} (dimod's SampleSet). It must exit with status
/// 0 within the time limit, and give the requested number of reads. Otherwise throws InputError with the end of its
/// stderr.
class CommandSampler final : public Sampler {
 public:
  explicit CommandSampler(const SamplerSettings& settings);
  std::string name() const override { return "command"; }
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override;

 private:
  SamplerSettings settings_;
};

/// One row per read instead of counts. Throws InputError unless there are `reads` rows. Messages begin with `source`.
SampleSet spread_reads(const SampleSet& answer, std::size_t reads, const std::string& source);

}  // namespace gonogo::learning
