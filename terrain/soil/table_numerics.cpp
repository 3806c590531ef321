#include "terrain/soil/table_numerics.h"

#include "base/error.h"

namespace gonogo::terrain {
namespace {

bool says_numerics(const Json& provenance) {
  if (!provenance.is_object()) return false;
  for (const char* key : {"step_s", "substeps", "iterations", "tolerance_m_per_s"})
    if (!provenance.find(key)) return false;
  return true;
}

}  // namespace

Numerics numerics_by_table(const Calibration& table, const std::filesystem::path& file, const AskedNumerics& asked) {
  if (!asked.complete() && !says_numerics(table.provenance))
    throw InputError(file.string() +
                     ": provenance does not say step_s, substeps, iterations and tolerance_m_per_s of the tests, and a "
                     "friction angle belongs to them; give --step, --substeps, --iterations, --tolerance and --target, "
                     "in a study all of trial.numerics, or calibrate again");
  Numerics n = asked.complete() ? Numerics{} : read_numerics(table.provenance);
  n.step = asked.step.value_or(n.step);
  n.substeps = asked.substeps.value_or(n.substeps);
  n.iterations = asked.iterations.value_or(n.iterations);
  n.tolerance = asked.tolerance.value_or(n.tolerance);
  n.target = asked.target.value_or(n.target);
  n.contact = asked.contact.value_or(n.contact);
  n.overlap = asked.overlap.value_or(n.overlap);
  if (sim::is_penalty(n.contact) && !asked.substeps) n.substeps = 1;
  return n;
}

}  // namespace gonogo::terrain
