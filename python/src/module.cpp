#include "python/src/binding.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <omp.h>

#include "base/error.h"
#include "base/files/shipped.h"
#include "base/version.h"
#include "pipeline/campaign/study/contract.h"

namespace nb = nanobind;

namespace gonogo::python {
namespace {

/// A processor without what the module was compiled for would end the process by SIGILL at the first packed loop.
void require_processor() {
#ifdef __AVX2__
  __builtin_cpu_init();
  if (!__builtin_cpu_supports("avx2"))
    throw nb::import_error(
        "this build of gonogo needs a processor with AVX2; build it here: "
        "pip install --no-binary gonogo gonogo -C cmake.define.CMAKE_CXX_FLAGS=");
#endif
}

void set_threads(int count) {
  if (count < 1) throw InputError("threads: " + std::to_string(count) + " given, at least 1 needed");
  omp_set_num_threads(count);
}

}  // namespace
}  // namespace gonogo::python

NB_MODULE(_core, m) {
  using namespace gonogo;
  python::require_processor();
  m.doc() = "The C++ library under the package gonogo. Use the package; names here may change.";
  python::bind_errors(m);
  m.def("version", &program_version, "Release, such as \"0.1.0\".");
  m.def("revision", &program_revision, "Git revision of the build.");
  m.def("contract_text", &campaign::contract_text, "JSON of all variables, measures, verdicts and reasons.");
  m.def(
      "outcome_names",
      [] {
        std::vector<std::string> names;
        for (const campaign::Outcome& outcome : campaign::contract().outcomes) names.push_back(outcome.name);
        return names;
      },
      "Outcomes of a valid trial, in the order of predictions.");
  m.def(
      "shipped_file",
      [](const std::string& kind, const std::string& what, const std::string& name) {
        return shipped_file(kind, what, name).string();
      },
      nb::arg("kind"), nb::arg("what"), nb::arg("name"), "Path of the file `name`, or of a shipped one of that name.");
  m.def("set_threads", &python::set_threads, nb::arg("count"),
        "Threads of predictions and samplers that this thread starts from now on.");
  m.def("max_threads", &omp_get_max_threads, "The number that set_threads() set; all cores at first.");
  python::bind_model(m);
  python::bind_machine(m);
  python::bind_problem(m);
  python::bind_dataset(m);
  python::bind_scene(m);
  python::bind_vehicle(m);
  python::bind_bodies(m);
  python::bind_simulation(m);
  python::bind_trial(m);
  python::bind_campaign(m);
}
