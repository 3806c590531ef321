// Soils by name and by numbers of a test: what they become in the model's variables, and what is refused.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/units.h"
#include "pipeline/map/region/region.h"
#include "terrain/soil/soil.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::map;

namespace {

std::vector<double> point_of(const std::string& text, const Region& region = {}) {
  return soil_points(region, named_soil(text, ""), {}, 1).at(0);
}

double angle_of(const std::vector<double>& point) { return point[contract().variable_index("friction_angle")]; }
double cohesion_of(const std::vector<double>& point) { return point[contract().variable_index("cohesion")]; }
double middle(const SoilSample& sample, const char* variable) {
  const Spread& s = sample.values.at(variable);
  return (s.low + s.high) / 2;
}

}  // namespace

TEST_CASE("numbers of a shear test become those of triaxial compression before the model is asked") {
  const auto box = point_of("direct_shear:phi=31,c=0.5");
  CHECK(angle_of(box) == Approx(terrain::angle_of_triaxial(31)));
  CHECK(cohesion_of(box) == Approx(0.5 / std::cos(to_radians(angle_of(box)))));
  const auto bevameter = point_of("bevameter:n=1.1,k_c=0.99,k_phi=1528,c=1.04,phi=28,K=25");
  CHECK(angle_of(bevameter) == Approx(terrain::angle_of_triaxial(28)));
  CHECK(angle_of(point_of("triaxial:phi=34,c=1")) == 34);
  CHECK(angle_of(point_of("plane_strain:phi=36,c=0")) == Approx(32));
  CHECK(point_of("repose:phi=30,density=0.3")[contract().variable_index("relative_density")] == 0.3);
  // By the model's own table where that has a curve on the plane of shear.
  Region region;
  region.table = terrain::read_calibration(GONOGO_SOURCE_DIR "/configs/soils/calibration_32mm.json");
  const terrain::MacroscopicSoil measured{28, 500, 0, 0.5, {terrain::StrengthTest::direct_shear}};
  CHECK(angle_of(point_of("direct_shear:phi=28,c=0.5,density=0.5", region)) ==
        Approx(as_triaxial(*region.table, measured).friction_angle));
  CHECK(angle_of(point_of("direct_shear:phi=28,c=0.5,density=0.5", region)) != Approx(terrain::angle_of_triaxial(28)));
}

TEST_CASE("a cone index of fine-grained soil and an unconfined strength become the cohesion that shows them") {
  const auto clay = point_of("cone:index=414,soil=cl,phi=15");
  CHECK(angle_of(clay) == 15);
  CHECK(terrain::cone_index(1e3 * cohesion_of(clay), 15) == Approx(414e3));
  const Soil one = named_soil("cone:index=414,soil=cl,phi=15", "");
  REQUIRE(one.samples.size() == 1);
  CHECK(one.samples[0].texture == "CL");
  CHECK(one.texture == "CL");
  CHECK(*one.samples[0].cone_index == Approx(414e3));
  // Without an angle each is an alternative, as long as friction alone does not show more.
  const Soil any = named_soil("cone:index=414,soil=silty clay,density=0.6", "");
  REQUIRE(any.samples.size() == 7);
  for (const SoilSample& s : any.samples) {
    CHECK(terrain::cone_index(1e3 * middle(s, "cohesion"), middle(s, "friction_angle")) == Approx(414e3));
    CHECK(s.alternative == &s - any.samples.data());
    CHECK(middle(s, "relative_density") == 0.6);
  }
  const auto crushed = point_of("unconfined:strength=60,phi=10");
  CHECK(cohesion_of(crushed) == Approx(30 * std::tan(to_radians(40))));
}

TEST_CASE("a bevameter whose plates its shear cannot bear is doubted, and so is a soil file's") {
  CHECK(named_soil("bevameter:n=1.1,k_c=0.99,k_phi=1528,c=1.04,phi=28,K=25", "").doubts.empty());
  const Soil torn = named_soil("bevameter:n=1.1,k_c=0.99,k_phi=30000,c=1.04,phi=28,K=25", "");
  REQUIRE(torn.doubts.size() == 1);
  CHECK(contains(torn.doubts[0], "plates and shear contradict each other by limit analysis"));
  CHECK(named_soil("lete_sand", "").doubts.size() == 1);
  CHECK(named_soil("dry_sand", "").doubts.empty());
}

TEST_CASE("numbers that say no strength, or too little of it, are refused with an example") {
  const auto refused = [](const std::string& text) { return input_error([&] { named_soil(text, ""); }); };
  CHECK(contains(refused("plate:n=1"), "has no friction angle phi, and plate alone tells no strength"));
  CHECK(contains(refused("plate:phi=30,c=1"), "shows no friction angle"));
  CHECK(contains(refused("cone:phi=30"), "has no cone index index"));
  CHECK(contains(refused("cone:index=414"), "tells a strength in fine-grained soil alone"));
  CHECK(contains(refused("cone:index=414,soil=SM"), "tells a strength in fine-grained soil alone"));
  CHECK(contains(refused("cone:index=414,soil=OH"), "\"OH\" is neither a class of the USCS with mineral grains"));
  CHECK(contains(refused("cone:index=9000,soil=CL,phi=10"), "the index means a cohesion beyond the 100 kPa"));
  CHECK(contains(refused("cone:index=12000,soil=CL"), "index 12000 is not between 0 and 10000"));
  CHECK(contains(refused("cone:index=5,soil=CL,phi=30"), "give a smaller angle"));
  CHECK(contains(refused("unconfined:strength=60"), "has no friction angle phi"));
  CHECK(contains(refused("direct_shear:phi=31"), "has no cohesion c; give for example"));
  CHECK(contains(refused("bevameter:c=1,phi=28"), "has no n"));
  CHECK(contains(refused("triaxial:phi=34,c=1,psi=3"), "\"psi\" is not known"));
  CHECK(contains(refused("triaxial:phi=steep"), "is no number by name"));
  CHECK(contains(refused("triaxial:phi=75,c=1"), "is not between 0 and 60"));
}

TEST_CASE("classes of the USCS have ranges dry, moist and wet, and organic ones are refused in one sentence") {
  for (const std::string& name : terrain::uscs_classes()) {
    CAPTURE(name);
    CHECK(named_soil(name, "").samples.size() == 3);
    const Soil wet = named_soil(name, "wet");
    REQUIRE(wet.samples.size() == 1);
    CHECK(wet.samples[0].texture == name);
    CHECK(terrain::is_fine_grained(name) == (name[0] == 'M' || name[0] == 'C'));
    CHECK(terrain::is_fine_grained(named_soil(name, "dry").samples[0].texture) == terrain::is_fine_grained(name));
  }
  for (const char* organic : {"Pt", "OH", "OL"})
    CHECK(contains(input_error([&] { named_soil(organic, ""); }), "is an organic class of the USCS"));
  CHECK(named_soil("sm", "dry").samples.size() == 1);
}

TEST_CASE("no texture or class but clean sand is weaker dry than moist, or moist than wet") {
  std::vector<std::string> names = terrain::usda_textures();
  names.insert(names.end(), terrain::uscs_classes().begin(), terrain::uscs_classes().end());
  for (const std::string& name : names) {
    CAPTURE(name);
    std::vector<SoilSample> by_moisture;
    for (const char* moisture : {"dry", "moist", "wet"})
      by_moisture.push_back(named_soil(name, moisture).samples.at(0));
    const bool clean_sand = name == "sand" || name == "SP" || name == "SW";
    for (std::size_t k = 0; k < 2; ++k)
      for (const char* variable : {"friction_angle", "cohesion"})
        if (!clean_sand) CHECK(middle(by_moisture[k], variable) >= middle(by_moisture[k + 1], variable));
    if (clean_sand) CHECK(middle(by_moisture[0], "cohesion") == middle(by_moisture[2], "cohesion"));
  }
}
