#include "pipeline/campaign/engine/compute.h"

#include <algorithm>

#include "base/cores.h"
#include "base/error.h"
#include "sim/simulation/device.h"

namespace gonogo::campaign {
namespace {

/// Enough worlds to keep a GPU busy with trials of some ten thousand contacts.
constexpr int kPlacesOfGpu = 64;

struct Section {
  std::optional<std::string> device;
  std::optional<int> places, workers;
  std::optional<double> checkpoint_every;
};

Section read_section(const Study& study) {
  Section s;
  const auto c = study.config.object_if("compute");
  if (!c) return s;
  if (c->has("device")) s.device = c->choice("device", {"cpu", "cuda"});
  if (c->has("places")) s.places = int(c->integer("places", {1, 4096}));
  if (c->has("workers")) s.workers = int(c->integer("workers", {1, 4096}));
  if (c->has("checkpoint_s")) s.checkpoint_every = c->number("checkpoint_s", {0, 1e6});
  c->finish();
  return s;
}

/// All GPUs that are used must be alike: bits are the same on one kind of device.
void use_gpus(ComputeSettings& s) {
  const std::vector<std::string> names = sim::cuda_device_names();
  if (names.empty())
    throw InputError("the study is to be computed on a GPU, and this build or machine has none; take --device cpu");
  for (const std::string& name : names)
    if (name != names.front())
      throw InputError("this machine has GPUs of two kinds (" + names.front() + ", " + name +
                       "), whose results may differ in their last bits; name those to use in CUDA_VISIBLE_DEVICES");
  s.device = sim::Backend::cuda;
  s.backend = "cuda, " + names.front();
  s.gpus = int(names.size());
}

}  // namespace

ComputeSettings read_compute(const Study& study, const ComputeRequest& request) {
  const Section section = read_section(study);
  ComputeSettings s;
  s.threads = threads_or_all(request.threads);
  if (request.device.value_or(section.device.value_or("cpu")) == "cuda") use_gpus(s);
  const bool on_gpu = s.gpus > 0;
  const auto chosen = [](const auto& first, const auto& second, auto otherwise) {
    return first ? *first : second.value_or(otherwise);
  };
  s.places = chosen(request.places, section.places, on_gpu ? kPlacesOfGpu : 1);
  s.workers = chosen(request.workers, section.workers, on_gpu ? s.gpus : s.threads);
  s.checkpoint_every = chosen(request.checkpoint_every, section.checkpoint_every, s.checkpoint_every);
  return s;
}

}  // namespace gonogo::campaign
