// A rolling tyre on the grains of the engine. Every beam of the belt carries a box of tread, which the engine moves as
// it is told. In each step of the engine the boxes go where the ring is, and the forces of their contacts act on the
// ring in its own, shorter steps until the next one. The ring's plane is x and z of the world, with z up; the tyre's
// width lies along y.
#pragma once
#include <memory>

#include "sim/elastic/tyre/roll.h"
#include "sim/simulation/simulation.h"

namespace gonogo::sim::elastic {

struct GrainGround {
  SceneWorld world;       // with its grains; gravity along -z
  StepSettings settings;  // penalty contact: explicit, as the ring is
  int material = 0;       // of the tread
  double x = 0, y = 0;    // of the hub at the start [m]
  double height = 0;      // of the hub at the start; the tread must not touch [m]
  int threads = 1;
};

/// Forces on the tread by place, mean over the steps of one advance().
struct TreadLoad {
  double forward = 0, upward = 0;    // [N]
  std::vector<double> x{}, force{};  // contacts of the last step: place before the hub [m], upward force [N]
};

class TyreOnGrains {
 public:
  /// Throws InputError as RollingTyre and make_simulation do, and for other than penalty contact.
  TyreOnGrains(const Tyre& tyre, const Hub& hub, GrainGround ground);

  /// Takes `count` steps of the engine.
  TreadLoad advance(long count);
  const RollingTyre& tyre() const { return tyre_; }
  RollingTyre& tyre() { return tyre_; }
  sim::Simulation& grains() { return *grains_; }
  double lowest() const;  // height of the tread's lowest point [m]

 private:
  void place_boxes();
  void take_forces(TreadLoad& load);

  Tyre shape_;
  RollingTyre tyre_;
  double x_, y_, step_;
  long substeps_ = 1;
  std::vector<BodyIndex> box_;
  std::unique_ptr<sim::Simulation> grains_;
};

}  // namespace gonogo::sim::elastic
