// Numerics of trials whose soil is met through a table: the table's, with what is asked for in their place.
#include "terrain/soil/calibration.h"

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

TEST_CASE("a table's give is taken, even when all other numerics are given, and older tables are rigid") {
  Numerics soft = kMeasured;
  soft.give = 0.6;
  const Calibration table = table_measured_with(soft);
  CHECK(numerics_by_table(table, "table.json") == soft);
  CHECK(description(soft) == description(kMeasured) + ", give 0.6");
  CHECK(step_settings(0.032, soft).give == Real(0.6));
  AskedNumerics all{1e-3, 14, 2, 0.0, sim::Target::coulomb};
  CHECK(numerics_by_table(table, "table.json", all) == soft);
  CHECK(numerics_by_table(table_measured_with(kMeasured), "table.json", all) == kMeasured);
  all.give = 0;
  CHECK(numerics_by_table(table, "table.json", all) == kMeasured);
  AskedNumerics springs;
  springs.contact = sim::ContactLaw::hertz;
  CHECK(numerics_by_table(table, "table.json", springs).give == 0);
  Json usual = Json::object();
  write_numerics(usual, kMeasured);
  CHECK(usual.find("give") == nullptr);  // files of rigid contacts stay as they were
}

TEST_CASE("penalty contact is chosen by one key, takes whole steps and is told in the table's words") {
  const Calibration table = table_measured_with(kMeasured);
  AskedNumerics asked;
  asked.contact = sim::ContactLaw::hertz;
  asked.step = 5e-5;
  const Numerics n = numerics_by_table(table, "table.json", asked);
  CHECK(n.substeps == 1);
  CHECK(n.contact == sim::ContactLaw::hertz);
  CHECK_FALSE(n == kMeasured);
  CHECK(description(n) == "step 5e-05 s, hertz, overlaps to 0.02 of a radius");
  Json written = Json::object();
  write_numerics(written, n);
  CHECK(read_numerics(written) == n);
  const sim::StepSettings s = step_settings(0.032, n);
  CHECK(s.contact == sim::ContactLaw::hertz);
  CHECK(s.penalty.modulus > 0);
  CHECK(step_settings(0.032, kMeasured).contact == sim::ContactLaw::complementarity);
  Json usual = Json::object();
  write_numerics(usual, kMeasured);
  CHECK(usual.find("contact") == nullptr);  // files of complementarity stay as they were
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
