#include "terrain/soil/soil.h"

#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/json/config.h"

namespace gonogo::terrain {

namespace {

SoilValue read_value(const Config& values, const std::string& key, Range allowed) {
  const Config c = values.object(key);
  SoilValue v;
  if (c.has("fixed") == c.has("range")) c.fail("", "needs either \"fixed\" or \"range\"");
  if (c.has("fixed")) {
    v.low = v.high = c.number("fixed", allowed);
  } else {
    const auto range = c.numbers("range", allowed);
    if (range.size() != 2 || !(range[0] <= range[1])) c.fail("range", "needs two numbers, the lower one first");
    v.low = range[0];
    v.high = range[1];
  }
  v.source = c.text_or("source", "");
  v.no_source = c.text_or("no_source", "");
  v.note = c.text_or("note", "");
  if (v.source.empty() == v.no_source.empty())
    c.fail("", "needs a \"source\", or \"no_source\" that says why the range is what it is");
  if (v.fixed() && c.has("range")) c.fail("range", "is one value; write it as \"fixed\"");
  c.finish();
  return v;
}

constexpr Range kAngles = {0, 60}, kCohesions = {0, 200};  // [deg], [kPa]

std::optional<SoilValue> value_if(const Config& c, const std::string& key, Range allowed) {
  return c.has(key) ? std::optional(read_value(c, key, allowed)) : std::nullopt;
}

/// Keys of Bekker's numbers: all three or none.
std::optional<Bekker> read_bekker(const Config& c, const std::string& prefix) {
  const std::string n = prefix + "n", k_c = prefix + "k_c_kN_per_m_n_plus_1",
                    k_phi = prefix + "k_phi_kN_per_m_n_plus_2";
  if (!c.has(n) && !c.has(k_c) && !c.has(k_phi)) return std::nullopt;
  return Bekker{read_value(c, n, {0.01, 3}), read_value(c, k_c, {-1e5, 1e5}), read_value(c, k_phi, {0, 1e6})};
}

std::optional<Range> range_if(const Config& c, const std::string& key, Range allowed) {
  if (!c.has(key)) return std::nullopt;
  const auto range = c.numbers(key, allowed);
  if (range.size() != 2 || !(range[0] <= range[1])) c.fail(key, "needs two numbers, the lower one first");
  return Range{range[0], range[1]};
}

/// Tests that show an angle, and a cohesion but for repose.
void read_envelope(const Config& c, SoilTest& t) {
  t.friction_angle = read_value(c, "friction_angle_deg", kAngles);
  if (t.meaning.test == StrengthTest::repose) return;
  t.meaning.stage = c.choice("stage", {"peak", "residual"}) == "peak" ? Stage::peak : Stage::residual;
  t.cohesion = read_value(c, "cohesion_kPa", kCohesions);
  t.normal_stress = range_if(c, "normal_stress_kPa", {0, 1e4});
  t.meaning.dilation = c.number_or("dilation_deg", 0, {-20, 40});
  if (t.meaning.is_on_plane()) t.janosi = value_if(c, "janosi_K_mm", {0.01, 1000});
}

void read_cone(const Config& c, SoilTest& t) {
  t.cone_index = value_if(c, "index_kPa", {0, 1e5});
  t.cone_gradient = value_if(c, "gradient_kPa_per_m", {0, 1e6});
  if (!t.cone_index && !t.cone_gradient) c.fail("", "needs \"index_kPa\" or \"gradient_kPa_per_m\"");
  t.cone_area = c.number_or("base_area_mm2", t.cone_area, {10, 1e5});
  t.cone_depth = range_if(c, "depth_m", {0, 5}).value_or(t.cone_depth);
}

/// A strength whose test was forgotten: says what each would mean.
void require_test(const Config& c) {
  if (c.has("test") || !c.has("friction_angle_deg")) return;
  const SoilValue angle = read_value(c, "friction_angle_deg", kAngles);
  c.fail("test", "is missing beside a friction angle: " + readings_of(angle.middle()) + "; name the test, one of " +
                     join_words(strength_test_names()));
}

SoilTest read_test(const Config& c) {
  SoilTest t;
  require_test(c);
  t.meaning.test = strength_test_of(c.choice("test", strength_test_names()));
  if (t.meaning.test == StrengthTest::unconfined) {
    t.unconfined_strength = read_value(c, "strength_kPa", {0, 1e4});
  } else if (t.meaning.test == StrengthTest::plate) {
    t.bekker = read_bekker(c, "");
    if (!t.bekker) c.fail("n", "is missing; a test of plates gives n, k_c_kN_per_m_n_plus_1, k_phi_kN_per_m_n_plus_2");
    if (c.has("widths_m")) t.plate_widths = c.numbers("widths_m", {1e-3, 10});
  } else if (t.meaning.test == StrengthTest::cone) {
    read_cone(c, t);
  } else {
    read_envelope(c, t);
  }
  c.text_or("note", "");
  c.finish();
  return t;
}

/// Schema 1: one angle, of triaxial compression.
void read_first_schema(const Config& v, SoilState& s) {
  SoilTest t{.meaning = {.assumed = true}};
  t.friction_angle = read_value(v, "friction_angle_deg", kAngles);
  t.cohesion = read_value(v, "cohesion_kPa", kCohesions);
  t.janosi = value_if(v, "janosi_K_mm", {0.01, 1000});
  s.tests.push_back(std::move(t));
  if (auto bekker = read_bekker(v, "bekker_")) {
    SoilTest plate{.meaning = {.test = StrengthTest::plate}};
    plate.bekker = std::move(bekker);
    s.tests.push_back(std::move(plate));
  }
}

/// What trials, maps and formulas take from the tests.
void choose_strength(const Config& c, SoilState& s) {
  const SoilTest* strength = nullptr;
  for (const SoilTest& t : s.tests) {
    if (t.friction_angle && !strength) strength = &t;
    if (t.bekker && !s.bekker) s.bekker = t.bekker;
    if (t.janosi && !s.janosi) s.janosi = t.janosi;
  }
  if (!strength)
    c.fail("tests",
           "none shows a friction angle; add one of triaxial, direct_shear, ring_shear, plane_strain or repose");
  s.meaning = strength->meaning;
  s.friction_angle = *strength->friction_angle;
  s.cohesion =
      strength->cohesion.value_or(SoilValue{0, 0, "", "a slope at rest tells no cohesion; none is assumed", ""});
}

/// A number outside of "tests" says no test: the file is of schema 1, or the test was forgotten.
void refuse_loose_strength(const Config& v) {
  if (!v.has("friction_angle_deg")) return;
  const SoilValue angle = read_value(v, "friction_angle_deg", kAngles);
  v.fail("friction_angle_deg",
         "does not say its test: " + readings_of(angle.middle()) + "; move it to \"tests\" with the test it is from");
}

void refuse_organic(const Config& c) {
  const std::string symbol = c.text("uscs");
  if (symbol == "Pt" || symbol == "OL" || symbol == "OH")
    c.fail("uscs", "is \"" + symbol +
                       "\", an organic class: grains have no fibres or peat; name the mineral class beneath, "
                       "one of " +
                       join_words(uscs_classes()) + ", or leave the class out");
}

SoilState read_state(const Config& c, bool first_schema) {
  SoilState s;
  s.name = c.text("name");
  if (c.has("uscs")) refuse_organic(c);
  s.texture = c.has("uscs") ? c.choice("uscs", uscs_classes()) : c.text_or("texture", "");
  s.note = c.text_or("note", "");
  if (c.has("moisture")) s.moisture = c.choice("moisture", {"dry", "moist", "wet"});
  if (c.has("water_percent")) s.water_percent = c.number("water_percent", {0, 1000});
  const Config v = c.object("values");
  if (first_schema) {
    read_first_schema(v, s);
  } else {
    refuse_loose_strength(v);
    for (const Config& test : c.objects("tests")) s.tests.push_back(read_test(test));
  }
  choose_strength(c, s);
  s.bulk_density = read_value(v, "bulk_density_kg_per_m3", {800, 2500});
  s.relative_density = read_value(v, "relative_density", {0, 1});
  v.finish();
  c.finish();
  return s;
}

Json fits_of(const Calibration& calibration, const std::vector<SoilState>& states) {
  Json rows = Json::array();
  for (const SoilState& s : states) rows.push_back(fit_record(calibration, s));
  return rows;
}

/// Pressure under the table's plate at one grain's depth, over that of the soil by Bekker; less one. Nothing where the
/// grains carry more than plates were pressed with.
std::optional<double> sinkage_mismatch(const Calibration& c, const SoilFit& fit, const Bekker& b) {
  const double z = c.grain_diameter, width = 4 * c.grain_diameter;
  const double soil = 1e3 * (b.k_c.middle() / width + b.k_phi.middle()) * std::pow(z, b.n.middle());
  const double grains = fit.sinkage_modulus * std::pow(z, fit.sinkage_exponent);
  if (!(grains < kMaxPlatePressure)) return {};
  return grains / soil - 1;
}

}  // namespace

MacroscopicSoil SoilState::macroscopic() const {
  return {friction_angle.middle(), 1e3 * cohesion.middle(), bulk_density.middle(), relative_density.middle(), meaning};
}

SoilFile read_soil(const std::filesystem::path& path) {
  const Config file = Config::read(path);
  const bool first_schema = file.choice("schema", {"gonogo/soil/1", "gonogo/soil/2"}) == "gonogo/soil/1";
  SoilFile soil;
  soil.name = file.text("name");
  soil.about = file.text("about");
  for (const Config& state : file.objects("states")) soil.states.push_back(read_state(state, first_schema));
  if (soil.states.empty()) file.fail("states", "needs at least one");
  if (file.has("fits")) {
    file.object("fits");
    soil.fits = file.json().at("fits");
  }
  file.finish();
  return soil;
}

Json fit_record(const Calibration& calibration, const SoilState& state) {
  Json j;
  j["state"] = state.name;
  try {
    const MacroscopicSoil soil = as_triaxial(calibration, state.macroscopic());
    if (!state.meaning.is_triaxial_peak()) {
      j["triaxial_friction_angle_deg"] = soil.friction_angle;
      j["triaxial_cohesion_kPa"] = soil.cohesion / 1e3;
    }
    const SoilFit f = fit_soil(calibration, soil);
    j["friction"] = double(f.law.friction);
    j["rolling_friction"] = double(f.law.rolling_friction);
    j["cohesion_pressure_Pa"] = double(f.law.cohesion_pressure);
    j["relative_density"] = f.relative_density;
    j["grain_density_kg_per_m3"] = f.grain_density;
    Json off;
    off["friction_angle_deg"] = f.friction_angle - soil.friction_angle;
    off["friction_angle_error_deg"] = f.friction_angle_error;
    off["cohesion"] = soil.cohesion > 0 ? f.cohesion / soil.cohesion - 1 : 0;
    off["cohesion_error"] = soil.cohesion > 0 ? f.cohesion_error / soil.cohesion : 0;
    off["bulk_density"] = f.bulk_density / soil.bulk_density - 1;
    off["relative_density"] = f.relative_density - soil.relative_density;
    if (state.bekker && f.sinkage_modulus > 0) {
      if (const auto sinkage = sinkage_mismatch(calibration, f, *state.bekker))
        off["sinkage"] = *sinkage;
      else
        off["plate_carries_above_Pa"] = kMaxPlatePressure;
    }
    j["mismatch"] = off;
  } catch (const InputError& e) {
    j["refused"] = std::string(e.what());
  }
  return j;
}

void write_fits(const std::filesystem::path& path, const std::string& table, const Calibration& calibration) {
  const SoilFile soil = read_soil(path);
  Json file = Json::read(path);
  Json fits = soil.fits.is_object() ? soil.fits : Json::object();
  fits[table] = fits_of(calibration, soil.states);
  file["fits"] = fits;
  write_file_atomically(path, file.dump(2) + "\n");
}

}  // namespace gonogo::terrain
