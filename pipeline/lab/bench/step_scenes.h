// Scenes whose steps the reference solvers take as problems, at any number of bodies.
//
//   filling   n x 10 x n spheres of radius 0.4 m and mass 1 kg under a lid of 10 n^2 kg that slides up and down in a
//             box. The filling test of Melanz, Jayakumar & Negrut (2017), as github.com/melanz/DVIDE sets it up.
//   drafting  a blade pushed through spheres of 8 to 16 mm at 0.2 m/s, of the same work: at 20,000 spheres a bin of 1.0
//             x 0.6 m and a blade of 0.2 m whose lower edge is 0.25 m above the floor. Fewer or more spheres: all
//             lengths but the spheres' scale with the cube root.
//   stack     a column of spheres of equal mass, the topmost ten times as heavy
//   wheel     a wheel of prescribed spin, held upright, on a bed of spheres
#pragma once
#include <string>
#include <vector>

#include "sim/local_problem/step_problem.h"
#include "sim/simulation/simulation.h"

namespace gonogo::lab {

/// A row of the table in step_scenes.cpp: step_scene("stack").
enum class StepScene : int {};
/// Throws InputError for another word.
StepScene step_scene(const std::string& name);
std::string step_scene_name(StepScene scene);
std::vector<std::string> step_scene_names();

/// One step of a scene that has settled. Sliding friction 0.5.
struct SceneStep {
  std::string name = {};       // scene and number of bodies
  int bodies = 0;              // that can move
  sim::SceneWorld world = {};  // bodies as they are at the start of the step
  sim::StepSettings settings = {};
  std::vector<sim::Contact> contacts = {};         // of the step
  std::vector<sim::Contact> earlier = {};          // of the step before
  std::vector<sim::Impulse> earlier_impulse = {};  // the engine's, by `earlier`
};

/// Settles the scene with the engine's `apgd` on `backend`, whose contacts the step has. `bodies`: about so many, at
/// least 1. Throws InputError for more than 1,000,000, and above 1000 for `stack`. Throws DeviceError when the engine
/// raises a flag, Cancelled when the user asked to stop.
SceneStep settled_step(StepScene scene, int bodies, int threads, sim::Backend backend = sim::Backend::cpu);

/// Not whole where W has more than `most_whole` blocks.
sim::StepProblem step_problem(const SceneStep& step, std::size_t most_whole = sim::StepProblem::kMostWhole);

/// The impulses of the step before, in the frames of the problem's contacts; 0 for new contacts. Contacts are known by
/// their bodies.
std::vector<double> warm_start(const SceneStep& step, const sim::StepProblem& problem);

}  // namespace gonogo::lab
