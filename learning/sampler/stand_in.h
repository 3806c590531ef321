// A sampler with a substitute for when it is unavailable.
#pragma once
#include <memory>
#include <string>

#include "learning/sampler/sampler.h"

namespace gonogo::learning {

/// Samples with `wanted` until it throws InputError or DeviceError, and with `other` from then on. stood_in() and
/// reason() report the switch.
class WithStandIn final : public Sampler {
 public:
  WithStandIn(std::unique_ptr<Sampler> wanted, std::unique_ptr<Sampler> other)
      : wanted_(std::move(wanted)), other_(std::move(other)) {}
  std::string name() const override { return stood_in() ? other_->name() : wanted_->name(); }
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override;
  bool stood_in() const { return !reason_.empty(); }
  const std::string& reason() const { return reason_; }
  std::string wanted_name() const { return wanted_->name(); }

 private:
  std::unique_ptr<Sampler> wanted_, other_;
  mutable std::string reason_;
};

}  // namespace gonogo::learning
