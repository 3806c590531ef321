// Scenes of many bodies, run for what they measure.
#pragma once
#include <string>

#include "pipeline/lab/scenes/scene.h"
#include "tests/support/catch.h"

namespace gonogo::test {

inline double value_of(const lab::ManyResult& r, const std::string& key) {
  for (const lab::SceneNumber& m : r.measured)
    if (m.key == key) return m.value;
  FAIL("nothing measured is called " << key);
  return 0;
}

inline lab::ManyResult run_on_one_core(const lab::ManyScene& scene) {
  lab::ManyRun run;
  run.repeats = 0;
  return run_many(scene, run);
}

}  // namespace gonogo::test
