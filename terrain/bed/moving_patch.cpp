#include "terrain/bed/moving_patch.h"

#include <cmath>

#include "base/error.h"
#include "base/format.h"

namespace gonogo::terrain {

void check_patch(const MovingPatch& patch, double grain_diameter) {
  const double slab = patch.length - 2 * patch.reach;
  if (!(slab >= 4 * grain_diameter))
    throw InputError("a bed of " + number_text(patch.length, 5) +
                     " m is too short for a moving patch: the vehicle needs " + number_text(2 * patch.reach, 5) +
                     " m and a slab of four grains; make the bed longer");
}

std::vector<GrainPlace> grain_places(const std::vector<sim::BodyState>& bodies, GrainShape shape, std::size_t count) {
  std::vector<Grain> grains(count);
  take_places(grains, shape, bodies);
  std::vector<GrainPlace> places;
  for (const Grain& g : grains) places.push_back({g.position, g.orientation});
  return places;
}

std::vector<sim::BodyIndex> virgin_grains(const MovingPatch& patch, const std::vector<GrainPlace>& start, double x) {
  std::vector<sim::BodyIndex> virgin;
  for (std::size_t i = 0; i < start.size(); ++i) {
    const double way = (start[i].position.x - x) / patch.length;  // periods; the nearest image is half of one away
    if (std::fabs(way - std::floor(way + 0.5)) * patch.length > patch.reach) virgin.push_back(sim::BodyIndex(i));
  }
  return virgin;
}

void renew_ground(sim::Simulation& simulation, sim::WorldIndex world, const MovingPatch& patch,
                  const std::vector<GrainPlace>& start, double x) {
  const std::vector<sim::BodyIndex> virgin = virgin_grains(patch, start, x);
  std::vector<sim::BodyState> states;
  for (const sim::BodyIndex i : virgin)
    states.push_back({start[std::size_t(i)].position, start[std::size_t(i)].orientation, {}, {}});
  simulation.set_bodies(world, virgin, states);
}

}  // namespace gonogo::terrain
