// Numerics of trials whose soil is met through a table: the table's, with what is asked for in their place.
#include "terrain/soil/table_numerics.h"

#include "base/error.h"
#include "tests/support/catch.h"

namespace gonogo::terrain {
namespace {

constexpr Numerics kMeasured{1e-3, 14, 2, 0, sim::Target::coulomb};

Calibration table_measured_with(const Numerics& n) {
  Calibration c{};
  c.provenance = Json::object();
  write_numerics(c.provenance, n);
  return c;
}

}  // namespace

TEST_CASE("a table's own numerics are taken, and what is asked for comes before them one by one") {
  const Calibration table = table_measured_with(kMeasured);
  CHECK(numerics_by_table(table, "table.json") == kMeasured);
  AskedNumerics asked;
  asked.iterations = 20;
  CHECK(numerics_by_table(table, "table.json", asked) == Numerics{1e-3, 14, 20, 0, sim::Target::coulomb});
  asked.step = 5e-4;
  asked.target = sim::Target::ccp;
  asked.substeps = 1;
  asked.tolerance = 2e-3;
  CHECK(numerics_by_table(table, "table.json", asked) == Numerics{5e-4, 1, 20, 2e-3, sim::Target::ccp});
  asked = {};
  asked.tolerance = 0.01;
  asked.step = 2e-3;
  CHECK(numerics_by_table(table, "table.json", asked) == Numerics{2e-3, 14, 2, 0.01, sim::Target::coulomb});
}

TEST_CASE("a table that does not say its numerics serves only who says them all") {
  Calibration table{};
  AskedNumerics asked{1e-3, 14, 2, 0.0, {}};
  for (const bool half : {false, true}) {
    if (half) {
      table.provenance = Json::object();
      table.provenance["step_s"] = 1e-3;
    }
    try {
      numerics_by_table(table, "old_table.json", asked);
      FAIL("accepted");
    } catch (const InputError& error) {
      CHECK(std::string(error.what()).find("old_table.json: provenance") != std::string::npos);
      CHECK(std::string(error.what()).find("--target") != std::string::npos);
    }
  }
  asked.target = sim::Target::coulomb;
  CHECK(numerics_by_table(table, "old_table.json", asked) == kMeasured);
}

}  // namespace gonogo::terrain
