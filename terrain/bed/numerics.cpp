#include "terrain/bed/numerics.h"

#include "base/error.h"
#include "base/line.h"
#include "sim/scene/target_name.h"

namespace gonogo::terrain {

std::string description(const Numerics& n) {
  return line("step %g s, %d x %d updates to %g m/s%s", n.step, n.substeps, n.iterations, n.tolerance,
              n.target == sim::Target::coulomb ? ", coulomb" : "");
}

void write_numerics(Json& object, const Numerics& n) {
  object["step_s"] = n.step;
  object["substeps"] = n.substeps;
  object["iterations"] = n.iterations;
  object["tolerance_m_per_s"] = n.tolerance;
  if (n.target != sim::Target::ccp) object["target"] = sim::name_of(n.target);
}

Numerics read_numerics(const Json& object) {
  Numerics n;
  n.step = object.at("step_s").number();
  n.substeps = int(object.at("substeps").integer());
  n.iterations = int(object.at("iterations").integer());
  n.tolerance = object.at("tolerance_m_per_s").number();
  if (const Json* target = object.find("target")) n.target = sim::target_named(target->string());
  return n;
}

}  // namespace gonogo::terrain
