#include "terrain/bed/numerics.h"

#include "base/error.h"
#include "base/line.h"
#include "sim/scene/contact_name.h"
#include "sim/scene/penalty_material.h"
#include "sim/scene/target_name.h"

namespace gonogo::terrain {

sim::StepSettings step_settings(double grain_diameter, const Numerics& n) {
  sim::StepSettings s = bed_step_settings(grain_diameter, n.step, n.iterations, n.tolerance);
  s.substeps = n.substeps;
  s.target = n.target;
  if (!sim::is_penalty(n.contact)) return s;
  s.solver = n.contact;
  s.penalty =
      sim::law_of_overlap(n.overlap, kOverlapSpeed, grain_diameter / 2, BedSpec{}.grain_density, kPenaltyRestitution);
  return s;
}

std::string description(const Numerics& n) {
  if (sim::is_penalty(n.contact))
    return line("step %g s, %s, overlaps to %g of a radius", n.step, sim::contact_name(n.contact), n.overlap);
  return line("step %g s, %d x %d updates to %g m/s%s", n.step, n.substeps, n.iterations, n.tolerance,
              n.target == sim::Target::coulomb ? ", coulomb" : "");
}

void write_numerics(Json& object, const Numerics& n) {
  object["step_s"] = n.step;
  object["substeps"] = n.substeps;
  object["iterations"] = n.iterations;
  object["tolerance_m_per_s"] = n.tolerance;
  if (n.target != sim::Target::ccp) object["target"] = sim::name_of(n.target);
  if (!sim::is_penalty(n.contact)) return;
  object["contact"] = sim::contact_name(n.contact);
  object["overlap"] = n.overlap;
}

Numerics read_numerics(const Json& object) {
  Numerics n;
  n.step = object.at("step_s").number();
  n.substeps = int(object.at("substeps").integer());
  n.iterations = int(object.at("iterations").integer());
  n.tolerance = object.at("tolerance_m_per_s").number();
  if (const Json* target = object.find("target")) n.target = sim::target_named(target->string());
  if (const Json* contact = object.find("contact")) n.contact = sim::contact_named(contact->string());
  if (const Json* overlap = object.find("overlap")) n.overlap = overlap->number();
  return n;
}

}  // namespace gonogo::terrain
