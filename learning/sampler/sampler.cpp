#include "learning/sampler/sampler.h"

#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/format.h"

namespace gonogo::learning {

extern const SamplerKind kBlockGibbs, kAnneal, kTempering, kPopulation, kExact, kTabu, kFile, kCommand;

namespace {

/// All samplers, in the order of lists for people.
const SamplerKind* const kSamplers[] = {&kBlockGibbs, &kAnneal, &kTempering, &kPopulation,
                                        &kExact,      &kTabu,   &kFile,      &kCommand};

class RegisteredSampler final : public Sampler {
 public:
  RegisteredSampler(const SamplerKind& kind, SamplerSettings settings) : kind_(kind), settings_(std::move(settings)) {}
  std::string name() const override { return kind_.name; }
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override {
    return kind_.sample(problem, request, settings_);
  }

 private:
  const SamplerKind& kind_;
  SamplerSettings settings_;
};

constexpr const char* kSettingTypes[] = {"true or false", "a whole number", "a number", "a text", "a list of texts"};

bool is_empty(const SettingValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return text->empty();
  const auto* texts = std::get_if<std::vector<std::string>>(&value);
  return texts && texts->empty();
}

void check_range(const SamplerParameter& parameter, double value, const std::string& where) {
  if (!std::isfinite(value)) throw InputError(where + " must be a finite number");
  const bool low = parameter.above_lowest ? value <= parameter.lowest : value < parameter.lowest;
  if (!low && value <= parameter.highest) return;
  const bool bounded = parameter.highest < std::numeric_limits<double>::max();
  throw InputError(where + " must be " + (parameter.above_lowest ? "above " : "at least ") +
                   number_text(parameter.lowest) + (bounded ? " and at most " + number_text(parameter.highest) : "") +
                   ", found " + number_text(value, 6));
}

SettingValue checked(const SamplerKind& kind, const SamplerParameter& parameter, SettingValue value) {
  const std::string where = std::string("sampler ") + kind.name + ": ";
  const auto* whole = std::get_if<std::int64_t>(&value);
  if (whole && std::holds_alternative<double>(parameter.fallback)) value = double(*whole);
  if (value.index() != parameter.fallback.index())
    throw InputError(where + parameter.name + " must be " + kSettingTypes[parameter.fallback.index()] + ", found " +
                     kSettingTypes[value.index()]);
  if (is_empty(value)) throw InputError(where + "no " + parameter.name + " is given");
  if (const auto* number = std::get_if<double>(&value)) check_range(parameter, *number, where + parameter.name);
  if (const auto* number = std::get_if<std::int64_t>(&value))
    check_range(parameter, double(*number), where + parameter.name);
  return value;
}

}  // namespace

std::span<const SamplerKind* const> samplers() { return kSamplers; }

std::vector<std::string> sampler_names(bool (*fits)(const SamplerKind& kind)) {
  std::vector<std::string> names;
  for (const SamplerKind* kind : kSamplers)
    if (!fits || fits(*kind)) names.emplace_back(kind->name);
  return names;
}

std::vector<std::string> sampler_names_and_emulator(bool (*fits)(const SamplerKind& kind)) {
  std::vector<std::string> names = sampler_names(fits);
  names.emplace_back(kEmulator);
  return names;
}

const SamplerKind& sampler_named(const std::string& name) {
  for (const SamplerKind* kind : kSamplers)
    if (kind->name == name) return *kind;
  const std::vector<std::string> names = sampler_names();
  throw InputError("sampler \"" + name + "\" does not exist; did you mean \"" + nearest_word(name, names) +
                   "\"? Samplers: " + join_words(names));
}

std::unique_ptr<Sampler> make_sampler(const std::string& name, const SamplerSettings& settings) {
  const SamplerKind& kind = sampler_named(name);
  SamplerSettings complete;
  std::vector<std::string> names;
  for (const SamplerParameter& parameter : kind.parameters) {
    const auto given = settings.find(parameter.name);
    names.emplace_back(parameter.name);
    complete[parameter.name] = checked(kind, parameter, given == settings.end() ? parameter.fallback : given->second);
  }
  for (const auto& [given, value] : settings)
    if (!complete.count(given))
      throw InputError("sampler " + name + ": no parameter \"" + given + "\"" +
                       (names.empty() ? "; it has none" : "; it has " + join_words(names)));
  return std::make_unique<RegisteredSampler>(kind, std::move(complete));
}

std::unique_ptr<Sampler> make_machine_sampler(const std::string& name, SamplerSettings settings) {
  for (const SamplerParameter& parameter : sampler_named(name).parameters)
    if (std::string(parameter.name) == "beta_end") settings.try_emplace("beta_end", 1.0);
  return make_sampler(name, settings);
}

SampleSet WithStandIn::sample(const Problem& problem, const SampleRequest& request) const {
  if (!stood_in()) {
    try {
      return wanted_->sample(problem, request);
    } catch (const InputError& error) {
      reason_ = error.what();
    } catch (const DeviceError& error) {
      reason_ = error.what();
    }
    std::fprintf(stderr, "sampler %s cannot be used, %s stands in: %s\n", wanted_->name().c_str(),
                 other_->name().c_str(), reason_.c_str());
  }
  return other_->sample(problem, request);
}

}  // namespace gonogo::learning
