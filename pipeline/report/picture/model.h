// The model of a picture: grains as spheres, all else as triangles. Everything is in the level frame: z against
// gravity, x horizontal and as near to the bed's x axis as that allows. A slope is then seen as a slope.
#pragma once
#include <vector>

#include "sim/io/capture.h"

namespace gonogo::report {

/// Linear red, green and blue, 0 to 1.
using Light = Vec3;

struct Ball {
  Vec3 centre;  // [m]
  Real radius;  // [m]
  Light colour;
};

struct Face {
  Vec3 corner[3], normal[3];  // [m]; unit, outward
  Light colour;
};

struct Model {
  std::vector<Ball> ball;
  std::vector<Face> face;
  Real floor = 0;  // height of the level ground that everything stands on [m]
};

enum class GrainColour { speed, height, material };

struct ModelStyle {
  GrainColour colour = GrainColour::speed;
  double low = 0, high = 1;   // ends of the colour bar [m/s] or [m, along the bed's normal]
  sim::BodyIndex focus = -1;  // body that a periodic world is drawn around; -1: the world's middle
};

/// Colour of the grains of a material; the colour-blind tell them apart, too.
Light material_colour(int material);

/// Colour of a share of the colour bar, 0 to 1.
Light bar_colour(double share);

/// Moving spheres have the colours of the bar or of their material, fixed ones that of the base. Wheels are rubber with
/// a rim, all else steel. Under a periodic bed a block of ground fills the space down to the floor. Under a vehicle
/// wider than its bed, copies of the bed are drawn side by side.
Model model_of(const sim::SceneWorld& world, const sim::Capture& frame, const ModelStyle& style);

/// A vehicle on a bed narrower than itself. The simulation folds its bodies into the bed's period; pictures show them
/// where joints hold them.
struct Unfolded {
  std::vector<sim::BodyState> body;  // [body], those that joints connect with the focus beside it
  std::vector<bool> beside;          // [body] connected with the focus, or the focus itself
  int copies = 1;                    // of the bed side by side that carry all of them, an odd number
};

/// `focus` may be -1: then nothing is unfolded.
Unfolded unfolded(const sim::SceneWorld& world, const sim::Capture& frame, sim::BodyIndex focus);

}  // namespace gonogo::report
