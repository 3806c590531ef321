// Samplers, which draw rows from P(x) proportional to exp(-E(x)), and the registry of those of this folder: each is a
// file that defines a SamplerKind, and its name in sampler.cpp. Command line, Python and training learn of it from
// there.
#pragma once
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "learning/qubo/problem.h"
#include "learning/qubo/sample_set.h"

namespace gonogo::learning {

struct SampleRequest {
  std::size_t reads = 1;
  std::uint64_t seed = 0;
  /// Markov-chain samplers: sweeps before a chain is read.
  std::size_t sweeps = 1000;
  /// Markov-chain samplers: `reads` rows to continue from, and the number of sweeps behind them. A chain of 3 + 4
  /// sweeps then has the bits of a chain of 7. Samplers without chains ignore both.
  const SampleSet* start = nullptr;
  std::uint64_t first_sweep = 0;
};

class Sampler {
 public:
  virtual ~Sampler() = default;
  virtual std::string name() const = 0;
  /// One row per read, in the order of chains. A pure function of problem and request. Throws InputError for problems
  /// that this sampler does not support.
  virtual SampleSet sample(const Problem& problem, const SampleRequest& request) const = 0;
};

/// A setting: a flag, a whole number, a number, a text, or a program with its arguments.
using SettingValue = std::variant<bool, std::int64_t, double, std::string, std::vector<std::string>>;
/// Settings of a sampler by name of the parameter.
using SamplerSettings = std::map<std::string, SettingValue>;

struct SamplerParameter {
  const char* name;       // "beta_start", as in Python
  const char* option;     // "--beta-start", of gonogo qubo sample; without dashes: what is given after all options
  const char* help;       // for lists of options
  SettingValue fallback;  // also says of which type it is; an empty text or program must be given
  double lowest = -std::numeric_limits<double>::max(), highest = std::numeric_limits<double>::max();  // of numbers
  bool above_lowest = false;  // the lowest number itself is too low
};

/// Of the `info` of an answer: the name of the sampler, where rows follow no distribution.
inline constexpr const char* kSearchOf = "search";

/// Where rows come from.
enum class RowOrigin { here, program, person };

struct SamplerKind {
  const char* name;   // "anneal"
  const char* title;  // "Annealer", the class in Python
  const char* about;  // one sentence
  std::vector<SamplerParameter> parameters = {};
  bool any_problem = true;       // false: bipartite problems only
  bool follows_energies = true;  // rows follow exp(-beta E); false: rows of low energy, of no distribution
  RowOrigin origin = RowOrigin::here;
  /// Whether this library draws its rows, and they follow exp(-beta E).
  bool draws_here() const { return origin == RowOrigin::here && follows_energies; }
  /// As Sampler::sample(). `settings` has a value of the right type and range for every parameter.
  SampleSet (*sample)(const Problem& problem, const SampleRequest& request, const SamplerSettings& settings) = nullptr;
};

std::span<const SamplerKind* const> samplers();
/// Names of those that fit, in the order of the registry.
std::vector<std::string> sampler_names(bool (*fits)(const SamplerKind& kind) = nullptr);
/// The emulated annealer (learning/annealer/emulator.h): a sampler beside the registry, since it needs a device.
inline constexpr const char* kEmulator = "emulator";
/// sampler_names(), then kEmulator.
std::vector<std::string> sampler_names_and_emulator(bool (*fits)(const SamplerKind& kind) = nullptr);
/// Throws InputError with the nearest name and all names.
const SamplerKind& sampler_named(const std::string& name);

/// `settings` of some parameters; the others have their defaults. Whole numbers do for numbers. Throws InputError for a
/// sampler or a parameter that does not exist, and for values of another type or out of range.
std::unique_ptr<Sampler> make_sampler(const std::string& name, const SamplerSettings& settings = {});

/// The same for rows of a machine's problem, P ~ exp(-E): beta_end is 1 unless it is given.
std::unique_ptr<Sampler> make_machine_sampler(const std::string& name, SamplerSettings settings = {});

/// A setting that make_sampler() has checked.
template <class T>
const T& setting(const SamplerSettings& settings, const std::string& name) {
  return std::get<T>(settings.at(name));
}

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

 private:
  std::unique_ptr<Sampler> wanted_, other_;
  mutable std::string reason_;
};

}  // namespace gonogo::learning
