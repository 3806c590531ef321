// Options and output that the commands of scenes of many bodies share.
#pragma once
#include <memory>
#include <string>

#include "pipeline/app/cli/bench_parts.h"
#include "pipeline/lab/scenes/scene.h"
#include "pipeline/lab/scenes/spheres.h"

namespace gonogo::app {

void add_sphere_count(CLI::App& command, Index& count);
void add_friction(CLI::App& command, lab::Spheres& of, const std::string& of_what);

/// A subcommand that makes a scene, runs, shows and times it, and prints what it measures. `count`: number of spheres,
/// which must live as long as `make`.
CLI::App* add_scene(CLI::App& parent, const Globals& globals, const char* name, const char* about, Index* count,
                    const std::function<lab::ManyScene(const lab::RunOn&)>& make);

/// The same for a scene that `make` builds from a spec with the spheres `of`.
template <class Spec>
CLI::App* add_scene(CLI::App& parent, const Globals& globals, const char* name, const char* about,
                    const std::shared_ptr<Spec>& spec, lab::Spheres& of,
                    lab::ManyScene (*make)(const Spec&, const lab::RunOn&)) {
  return add_scene(parent, globals, name, about, &of.count,
                   [spec, make](const lab::RunOn& on) { return make(*spec, on); });
}

/// The first entries of every scene's result.
Json counts_json(const std::string& scene, const lab::RunOn& on, std::int64_t spheres, std::int64_t bodies,
                 std::int64_t contacts);

/// Times of the stages from `first` to `last` [ms].
Json stages_json(const sim::StageTimes& times, sim::Stage first, sim::Stage last);
std::string stages_text(const sim::StageTimes& times, sim::Stage first, sim::Stage last);

}  // namespace gonogo::app
