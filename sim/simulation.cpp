#include "sim/simulation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "sim/broad_phase/layout.h"
#include "sim/shape/check.h"

namespace gonogo::sim {
namespace {

std::string in_world(std::size_t w) { return "world " + std::to_string(w) + ": "; }

void check_world(const SceneWorld& world, std::size_t w) {
  if (world.body.empty()) throw InputError(in_world(w) + "has no bodies");
  if (!(world.size.x > 0 && world.size.y > 0 && world.size.z > 0))
    throw InputError(in_world(w) + "its size must be above zero");
  check_shapes(world, w);
}

void check_drives(const SceneWorld& world, std::size_t w) {
  const auto exists = [&](BodyIndex b) { return b >= 0 && b < BodyIndex(world.body.size()); };
  std::vector<bool> driven(world.body.size());
  for (const Motor& m : world.motor) {
    if (!exists(m.body) || !(world.mass[m.body].inverse_inertia_B.y > 0))
      throw InputError(in_world(w) + "a motor needs a body that can turn about its y axis");
    if (driven[m.body]) throw InputError(in_world(w) + "a body has two motors; join them into one");
    driven[m.body] = true;
  }
  for (const SpringDamper& s : world.spring)
    if (!exists(s.upper) || !exists(s.lower) ||
        !(world.mass[s.upper].inverse_mass.z + world.mass[s.lower].inverse_mass.z > 0))
      throw InputError(in_world(w) + "a spring needs two bodies, at least one of them free to move along z");
}

WorldParameters world_parameters(const SceneWorld& world, const StepSettings& settings, std::size_t w) {
  WorldParameters p;
  p.gravity = world.gravity;
  p.origin = world.origin;
  p.period = {world.periodic_x ? world.size.x : 0, world.periodic_y ? world.size.y : 0, 0};
  std::copy(&world.law[0][0], &world.law[0][0] + kMaxMaterials * kMaxMaterials, &p.law[0][0]);
  lay_out_bins(world, settings, w, p);
  return p;
}

/// Bins of all worlds up to this one.
Index with_bins_of(const WorldParameters& p, Index before, std::size_t w) {
  const std::int64_t count = before + std::int64_t(p.bins[0]) * p.bins[1] * p.bins[2];
  if (count > std::numeric_limits<Index>::max())
    throw InputError(in_world(w) + "the batch needs " + std::to_string(count) + " bins up to here, more than " +
                     std::to_string(std::numeric_limits<Index>::max()) + "; use fewer worlds in a batch");
  return Index(count);
}

void append_shapes(const SceneWorld& world, Real limit, BodyIndex first_body, FlatScene& flat, WorldParameters& p) {
  p.first_large = Index(flat.large.size());
  std::size_t next = 0;
  for (BodyIndex b = 0; b < BodyIndex(world.body.size()); ++b) {
    flat.first_shape.push_back(Index(flat.shape.size()));
    for (; next < world.shape.size() && world.shape[next].body == b; ++next) {
      Shape s = world.shape[next];
      s.body += first_body;
      const bool binned = is_binned(s, limit);
      if (!binned) flat.large.push_back({ShapeIndex(flat.shape.size()), {}, {}, {}});
      flat.bin_of_shape.push_back(binned ? 0 : -1);
      flat.shape.push_back(s);
    }
  }
  p.large_count = Index(flat.large.size()) - p.first_large;
}

}  // namespace

FlatScene flatten(const Scene& scene, const StepSettings& settings) {
  FlatScene flat;
  for (std::size_t w = 0; w < scene.size(); ++w) {
    const SceneWorld& world = scene[w];
    check_world(world, w);
    check_drives(world, w);
    WorldParameters p = world_parameters(world, settings, w);
    p.first_body = BodyIndex(flat.body.size());
    p.body_count = Index(world.body.size());
    p.first_bin = flat.bin_count;
    flat.bin_count = with_bins_of(p, flat.bin_count, w);
    append_shapes(world, binned_radius(world, settings), p.first_body, flat, p);
    flat.body.insert(flat.body.end(), world.body.begin(), world.body.end());
    for (BodyMass m : world.mass) {
      m.isotropic = m.inverse_inertia_B.x == m.inverse_inertia_B.y && m.inverse_inertia_B.y == m.inverse_inertia_B.z;
      m.motor = -1;
      flat.mass.push_back(m);
    }
    flat.world_of_body.insert(flat.world_of_body.end(), world.body.size(), WorldIndex(w));
    flat.first_motor.push_back(Index(flat.motor.size()));
    for (Motor m : world.motor) {
      m.body += p.first_body;
      flat.mass[m.body].motor = std::int32_t(flat.motor.size());
      flat.motor.push_back(m);
    }
    flat.first_spring.push_back(Index(flat.spring.size()));
    for (SpringDamper s : world.spring) {
      s.upper += p.first_body;
      s.lower += p.first_body;
      flat.spring.push_back(s);
    }
    flat.world.push_back(p);
  }
  flat.first_shape.push_back(Index(flat.shape.size()));
  return flat;
}

std::unique_ptr<Simulation> make_simulation(Backend backend, const Scene& scene, const StepSettings& settings,
                                            int threads) {
  if (scene.empty()) throw InputError("the scene has no worlds");
  if (!(settings.step > 0) || settings.iterations < 1)
    throw InputError("the step must be above zero and there must be at least one iteration");
  const FlatScene flat = flatten(scene, settings);
  if (backend == Backend::cpu) return make_cpu_simulation(flat, settings, threads);
#ifdef GONOGO_WITH_CUDA
  return make_cuda_simulation(flat, settings);
#else
  throw InputError("this program was built without CUDA; build the cuda-release preset or ask for the cpu backend");
#endif
}

}  // namespace gonogo::sim
