#include "pipeline/inspect/soil_tests.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/progress.h"
#include "base/units.h"
#include "pipeline/report/figure/captioned.h"
#include "pipeline/report/figure/film.h"
#include "terrain/soil_test/repose.h"

namespace gonogo::inspect {
namespace {

/// Runs of one test side by side under one progress line.
class Runs {
 public:
  Runs(const std::string& test, const SoilTestRequest& request, std::size_t count, Index steps_each)
      : request_(request),
        count_(count),
        usual_(count * std::size_t(steps_each)),
        progress_("soil test " + test, "steps", usual_) {}

  /// job(k, pace) for each run.
  template <class Job>
  void operator()(Job job) {
    const int side_by_side = std::max(1, std::min(request_.threads, int(count_)));
    terrain::TestBench bench(request_.device, side_by_side);
    terrain::TestPace pace = request_.numerics ? terrain::pace_of(*request_.numerics) : terrain::TestPace{};
    pace.threads = std::max(1, request_.threads / side_by_side);
    pace.on_steps = [this](Index steps) {
      const std::lock_guard lock(mutex_);
      done_ += std::size_t(steps);
      progress_.update(std::min(done_, usual_));  // strong soil takes more steps than usual
    };
    pace.bench = &bench;
    bench.run(count_, [&](std::size_t k) { job(k, pace); });
    progress_.finish();
  }

 private:
  const SoilTestRequest& request_;
  std::size_t count_, usual_, done_ = 0;
  std::mutex mutex_;
  Progress progress_;
};

double steps_per(double time, double own, const SoilTestRequest& r) {
  return r.numerics ? time / r.numerics->step : own;
}

/// Steps in a test's unit of time: the test's own number, unless the request asks for the step of trials.
double steps_per_gravity_time(double own, const SoilTestRequest& r) {
  return steps_per(terrain::gravity_time(r.soil.grain_diameter), own, r);
}

double steps_per_stress_time(double stress, double own, const SoilTestRequest& r) {
  return steps_per(terrain::stress_time(r.soil.grain_diameter, r.soil.grain_density, stress), own, r);
}

/// The soil of run k: its seed is k more.
terrain::TestSoil seeded(const SoilTestRequest& r, std::size_t k) {
  terrain::TestSoil soil = r.soil;
  soil.seed += k;
  return soil;
}

/// Stress [Pa] and seed of a run, for each stress and seed of the request.
struct Load {
  double stress;
  std::size_t seed;
};
std::vector<Load> loads_of(const SoilTestRequest& r) {
  std::vector<Load> loads;
  for (const double stress : r.stresses)
    for (std::size_t s = 0; s < std::size_t(r.seeds); ++s) loads.push_back({stress, s});
  return loads;
}

SoilTestOutcome begin(const std::string& test, const SoilTestRequest& r) {
  SoilTestOutcome o{.test = test, .request = r};
  o.plot.title = line("Virtual %s test: %ss of %g mm, friction %g, rolling %g", test.c_str(),
                      terrain::name_of(r.soil.shape).c_str(), 1e3 * r.soil.grain_diameter,
                      double(r.soil.grain.friction), double(r.soil.grain.rolling_friction));
  if (r.soil.grain.cohesion_pressure > 0)
    o.plot.title += line(", cohesion pressure %g kPa", double(r.soil.grain.cohesion_pressure) / 1e3);
  return o;
}

SoilTestOutcome repose(const SoilTestRequest& r) {
  terrain::ReposeSettings settings;
  if (r.quick) {
    settings.length = 16;
    settings.height = 8;
  }
  settings.steps_per_time = steps_per_gravity_time(settings.steps_per_time, r);
  std::vector<terrain::ReposeResult> results(std::size_t(r.seeds));
  SoilTestOutcome o = begin("repose", r);
  Runs runs("repose", r, results.size(), terrain::repose_steps(settings));
  runs([&](std::size_t k, const terrain::TestPace& pace) {
    results[k] = repose_test(seeded(r, k), settings, pace, k + 1 == results.size() ? &o.scene : nullptr);
  });
  o.csv = "seed,x_m,height_m\n";
  o.plot.x_label = "distance from the far wall [m]";
  o.plot.y_label = "height of the surface [m]";
  std::vector<double> angles;
  double rest = 0;
  for (std::size_t k = 0; k < results.size(); ++k) {
    angles.push_back(results[k].angle.degrees);
    o.note_residual(results[k].worst_residual);
    rest = std::max(rest, results[k].rest_speed);
    report::PlotLine profile{line("seed %zu: %.1f deg", std::size_t(r.soil.seed) + k, angles.back()), {}, {}, false};
    for (const auto& s : results[k].profile) {
      o.csv += line("%zu,%.5f,%.5f\n", std::size_t(r.soil.seed) + k, s.x, s.height);
      profile.add(s.x, s.height);
    }
    o.plot.lines.push_back(profile);
  }
  const MeanError mean = mean_error(angles);
  const double error = angles.size() > 1 ? mean.error : results[0].angle.error;
  o.repose = {{mean.mean, error}, rest};
  o.plot.notes = {line("Angle of repose %.1f +- %.1f degrees.", mean.mean, error)};
  return o;
}

std::string bekker_text(const terrain::BekkerFit& fit) {
  return line("Bekker: k_c %.2f +- %.2f kN/m^(n+1), k_phi %.0f +- %.0f kN/m^(n+2), n %.2f +- %.2f", fit.k_c / 1e3,
              fit.k_c_error / 1e3, fit.k_phi / 1e3, fit.k_phi_error / 1e3, fit.n, fit.n_error);
}

/// One for each plate width.
std::vector<terrain::PlateSettings> plate_settings(const SoilTestRequest& r) {
  std::vector<terrain::PlateSettings> settings(r.plate_widths.size());
  for (std::size_t k = 0; k < settings.size(); ++k) {
    settings[k].width_grains = r.plate_widths[k];
    if (r.quick) {
      settings[k].bed_depth = 2;
      settings[k].growth_time = 3;
    }
    settings[k].steps_per_time = steps_per_gravity_time(settings[k].steps_per_time, r);
  }
  return settings;
}

/// Curves of all runs, the widths of one seed after those of another, and the fitted curve of each width.
void draw_plates(SoilTestOutcome& o, const std::vector<terrain::PlateResult>& results, std::size_t widths,
                 const terrain::BekkerFit& fit, std::uint64_t first_seed) {
  o.csv = "plate_width_m,seed,sinkage_m,pressure_Pa\n";
  o.plot.x_label = "sinkage [mm]";
  o.plot.y_label = "pressure [kPa]";
  for (std::size_t k = 0; k < results.size(); ++k) {
    report::PlotLine curve{k < widths ? line("b = %.0f mm", 1e3 * results[k].width) : "", {}, {}, true};
    report::PlotLine fitted{k < widths ? line("Bekker, %.0f mm", 1e3 * results[k].width) : "", {}, {}, false};
    curve.colour = fitted.colour = int(k % widths);
    for (const auto& s : results[k].curve) {
      o.csv +=
          line("%.4f,%zu,%.6f,%.2f\n", results[k].width, std::size_t(first_seed) + k / widths, s.sinkage, s.pressure);
      if (s.sinkage < 0) continue;
      curve.add(1e3 * s.sinkage, s.pressure / 1e3);
      fitted.add(1e3 * s.sinkage, (fit.k_c / results[k].width + fit.k_phi) * std::pow(s.sinkage, fit.n) / 1e3);
    }
    o.plot.lines.push_back(curve);
    if (k < widths) o.plot.lines.push_back(fitted);
  }
}

SoilTestOutcome plate(const SoilTestRequest& r) {
  SoilTestOutcome o = begin("plate", r);
  const std::vector<terrain::PlateResult> results = run_plates(r, &o.scene);
  const terrain::BekkerFit fit = fit_bekker(results);
  draw_plates(o, results, r.plate_widths.size(), fit, r.soil.seed);
  o.plate = fit;
  o.plot.notes = {bekker_text(fit)};
  for (const terrain::PlateResult& result : results) o.note_residual(result.worst_residual);
  return o;
}

/// Mean of the beds over depth, and from the least to the most of them as a band.
void draw_cone(report::LinePlot& plot, const std::vector<terrain::ConeResult>& results) {
  plot.x_label = "depth of the cone's base [mm]";
  plot.y_label = "force over base area [kPa]";
  report::PlotLine band, mean;
  const std::vector<terrain::ConeSample> profile = mean_profile(results);
  for (std::size_t k = 0; k < profile.size(); ++k) {
    const auto [lowest, highest] = std::minmax_element(
        results.begin(), results.end(),
        [k](const auto& a, const auto& b) { return a.profile[k].pressure < b.profile[k].pressure; });
    band.x.push_back(1e3 * profile[k].depth);
    mean.x.push_back(1e3 * profile[k].depth);
    band.y.push_back(lowest->profile[k].pressure / 1e3);
    band.upper.push_back(highest->profile[k].pressure / 1e3);
    mean.y.push_back(profile[k].pressure / 1e3);
  }
  band.colour = mean.colour = 0;
  if (results.size() > 1) {
    band.label = "least to most";
    mean.label = line("mean of %zu beds", results.size());
    plot.lines.push_back(band);
  }
  plot.lines.push_back(mean);
}

ConeNumbers cone_numbers(const std::vector<terrain::ConeResult>& results, double depth) {
  ConeNumbers cone{.diameter = results[0].diameter, .depth = depth, .gradient = fit_cone(results)};
  std::vector<double> index;
  for (const terrain::ConeResult& one : results) {
    index.push_back(one.index);
    cone.bulk_density += one.bulk_density / double(results.size());
  }
  cone.index = mean_error(index);
  return cone;
}

std::string cone_text(const ConeNumbers& c) {
  return line("cone of %.0f mm: index %.1f +- %.1f kPa to a depth of %.0f mm, gradient %.3f +- %.3f MPa/m",
              1e3 * c.diameter, c.index.mean / 1e3, c.index.error / 1e3, 1e3 * c.depth, c.gradient.slope / 1e6,
              c.gradient.slope_error / 1e6);
}

SoilTestOutcome cone(const SoilTestRequest& r) {
  terrain::ConeSettings settings;
  settings.diameter_grains = r.cone_diameter;
  if (r.quick) settings.speed = 0.2;
  settings.steps_per_time = steps_per_gravity_time(settings.steps_per_time, r);
  std::vector<terrain::ConeResult> results(std::size_t(r.seeds));
  SoilTestOutcome o = begin("cone", r);
  Runs runs("cone", r, results.size(), terrain::cone_steps(settings));
  runs([&](std::size_t k, const terrain::TestPace& pace) {
    results[k] = cone_test(seeded(r, k), settings, pace, k + 1 == results.size() ? &o.scene : nullptr);
  });
  o.csv = "cone_diameter_m,seed,depth_m,pressure_Pa\n";
  for (std::size_t k = 0; k < results.size(); ++k) {
    o.note_residual(results[k].worst_residual);
    for (const auto& s : results[k].curve)
      o.csv += line("%.4f,%zu,%.6f,%.2f\n", results[k].diameter, std::size_t(r.soil.seed) + k, s.depth, s.pressure);
  }
  draw_cone(o.plot, results);
  o.cone = cone_numbers(results, settings.depth * results[0].diameter);
  o.plot.notes = {cone_text(*o.cone)};
  return o;
}

std::string steady_text(const terrain::ShearStrength& s) {
  return line("steady: friction angle %.1f +- %.1f deg, cohesion %.0f +- %.0f Pa, R2 %.4f", s.steady_angle.degrees,
              s.steady_angle.error, s.steady_cohesion, s.steady_cohesion_error, s.steady_r2);
}
std::string peak_text(const terrain::ShearStrength& s) {
  return line("peak:   friction angle %.1f +- %.1f deg, cohesion %.0f +- %.0f Pa, R2 %.4f", s.peak_angle.degrees,
              s.peak_angle.error, s.peak_cohesion, s.peak_cohesion_error, s.peak_r2);
}

SoilTestOutcome shear(const SoilTestRequest& r) {
  const std::vector<Load> loads = loads_of(r);
  SoilTestOutcome o = begin("shear", r);
  const std::vector<terrain::ShearResult> results = run_shear(r, &o.scene);
  o.csv = "normal_stress_Pa,seed,travel_grains,shear_stress_Pa,measured_normal_stress_Pa,rise_grains\n";
  o.plot.x_label = "travel of the plate, grain diameters";
  o.plot.y_label = "shear stress [kPa]";
  for (std::size_t k = 0; k < loads.size(); ++k) {
    o.note_residual(results[k].worst_residual);
    report::PlotLine curve{loads[k].seed == 0 ? line("%g kPa", loads[k].stress / 1e3) : "", {}, {}, false};
    for (const auto& s : results[k].curve) {
      o.csv += line("%g,%zu,%.4f,%.2f,%.2f,%.5f\n", loads[k].stress, std::size_t(r.soil.seed) + loads[k].seed, s.travel,
                    s.shear_stress, s.normal_stress, s.rise);
      curve.add(s.travel, s.shear_stress / 1e3);
    }
    o.plot.lines.push_back(curve);
  }
  o.shear = terrain::shear_strength(results);
  o.plot.notes = {steady_text(*o.shear), peak_text(*o.shear)};
  return o;
}

SoilTestOutcome triaxial(const SoilTestRequest& r) {
  const std::vector<Load> loads = loads_of(r);
  terrain::TriaxialSettings settings;
  settings.inertial_number = r.inertial_number.value_or(settings.inertial_number);
  if (r.quick) {
    settings.grains_wide = 7;
    settings.grains_high = 12;
  }
  std::vector<terrain::TriaxialResult> results(loads.size());
  SoilTestOutcome o = begin("triaxial", r);
  Runs runs("triaxial", r, loads.size(), terrain::triaxial_steps(settings));
  runs([&](std::size_t k, const terrain::TestPace& pace) {
    terrain::TriaxialSettings own = settings;
    own.confining_stress = loads[k].stress;
    own.steps_per_time = steps_per_stress_time(own.confining_stress, own.steps_per_time, r);
    results[k] = triaxial_test(seeded(r, loads[k].seed), own, pace, k + 1 == loads.size() ? &o.scene : nullptr);
  });
  o.csv = "confining_stress_Pa,seed,strain,axial_stress_Pa,lateral_stress_Pa,volume_strain\n";
  o.plot.x_label = "axial strain";
  o.plot.y_label = "deviator stress over lateral stress";
  double fraction = 0;
  for (std::size_t k = 0; k < loads.size(); ++k) {
    o.note_residual(results[k].worst_residual);
    fraction += results[k].solid_fraction / double(loads.size());
    report::PlotLine curve{loads[k].seed == 0 ? line("%g kPa", loads[k].stress / 1e3) : "", {}, {}, false};
    for (const auto& s : results[k].curve) {
      o.csv += line("%g,%zu,%.5f,%.2f,%.2f,%.6f\n", loads[k].stress, std::size_t(r.soil.seed) + loads[k].seed, s.strain,
                    s.axial_stress, s.lateral_stress, s.volume_strain);
      curve.add(s.strain, s.axial_stress / s.lateral_stress - 1);
    }
    o.plot.lines.push_back(curve);
  }
  o.triaxial = {triaxial_strength(results, r.soil.grain.cohesion_pressure > 0), fraction};
  const terrain::TriaxialStrength& s = o.triaxial->strength;
  o.plot.notes = {line("Friction angle: steady %.1f +- %.1f, peak %.1f +- %.1f degrees.", s.steady_angle.degrees,
                       s.steady_angle.error, s.peak_angle.degrees, s.peak_angle.error)};
  return o;
}

constexpr struct {
  const char* name;
  SoilTestOutcome (*run)(const SoilTestRequest&);
} kSoilTests[] = {{"repose", repose}, {"shear", shear}, {"plate", plate}, {"cone", cone}, {"triaxial", triaxial}};

/// What was tested, the same for all tests.
Json soil_json(const SoilTestRequest& r) {
  Json j;
  j["grain_diameter_m"] = r.soil.grain_diameter;
  j["shape"] = terrain::name_of(r.soil.shape);
  j["friction"] = double(r.soil.grain.friction);
  j["rolling_friction"] = double(r.soil.grain.rolling_friction);
  j["cohesion_pressure_Pa"] = double(r.soil.grain.cohesion_pressure);
  j["tool_friction"] = r.soil.tool_friction;
  j["relative_density"] = r.soil.relative_density;
  j["grain_density_kg_per_m3"] = r.soil.grain_density;
  j["seeds"] = r.seeds;
  j["first_seed"] = std::uint64_t(r.soil.seed);
  if (r.numerics) terrain::write_numerics(j["numerics"], *r.numerics);
  return j;
}

Json angle_json(const terrain::Angle& a) { return Json::Object{{"deg", a.degrees}, {"error_deg", a.error}}; }

void add_bekker(Json& json, const terrain::BekkerFit& fit) {
  json["k_c_kN_per_m_n_plus_1"] = fit.k_c / 1e3;
  json["k_c_error"] = fit.k_c_error / 1e3;
  json["k_phi_kN_per_m_n_plus_2"] = fit.k_phi / 1e3;
  json["k_phi_error"] = fit.k_phi_error / 1e3;
  json["n"] = fit.n;
  json["n_error"] = fit.n_error;
  json["r2"] = fit.r2;
}

void add_cone(Json& json, const ConeNumbers& c) {
  json["cone_diameter_m"] = c.diameter;
  json["cone_index_kPa"] = c.index.mean / 1e3;
  json["cone_index_error_kPa"] = c.index.error / 1e3;
  json["gradient_MPa_per_m"] = c.gradient.slope / 1e6;
  json["gradient_error_MPa_per_m"] = c.gradient.slope_error / 1e6;
  json["r2"] = c.gradient.r2;
  json["bulk_density_kg_per_m3"] = c.bulk_density;
}

/// Shear tests give R2, triaxial ones do not.
template <class Strength>
void add_strength(Json& json, const Strength& s) {
  constexpr bool has_r2 = requires { s.peak_r2; };
  json["friction_angle"] = angle_json(s.steady_angle);
  json["cohesion_Pa"] = s.steady_cohesion;
  json["cohesion_error_Pa"] = s.steady_cohesion_error;
  if constexpr (has_r2) json["r2"] = s.steady_r2;
  json["peak_friction_angle"] = angle_json(s.peak_angle);
  json["peak_cohesion_Pa"] = s.peak_cohesion;
  json["peak_cohesion_error_Pa"] = s.peak_cohesion_error;
  if constexpr (has_r2) json["peak_r2"] = s.peak_r2;
}

/// The grains in colours of their height.
void draw_scene(const std::filesystem::path& path, const std::string& title, const terrain::TestScene& scene,
                int threads) {
  double low = 1e30, high = -1e30;
  for (const sim::Shape& s : scene.world.shape) {
    if (s.type != sim::ShapeType::sphere || sim::is_fixed(scene.world.mass[std::size_t(s.body)])) continue;
    const double z = sim::centre_of(s, scene.end.body[std::size_t(s.body)]).z + double(s.size.x);
    low = std::min(low, z);
    high = std::max(high, z);
  }
  // Walls would hide the grains.
  sim::SceneWorld shown = scene.world;
  std::erase_if(shown.shape, [](const sim::Shape& s) { return s.type == sim::ShapeType::plane; });
  const report::Model model =
      report::model_of(shown, scene.end, {.colour = report::GrainColour::height, .low = low, .high = high});
  const report::ShotFile file{.path = path, .threads = threads};
  const report::Camera camera =
      report::frame_model(model, 16 * kDegree, 16 * kDegree, double(file.width) / file.height, report::kCaptionMargins);
  report::Caption caption{.title = title};
  report::add_bar(caption, "height of grain [m]", low, high);
  report::write_shot(file, model, camera, caption);
}

}  // namespace

std::vector<terrain::PlateResult> run_plates(const SoilTestRequest& r, terrain::TestScene* scene) {
  if (r.plate_widths.size() < 2)
    throw InputError("soil test plate: two plate widths or more are needed for k_c and k_phi");
  const std::vector<terrain::PlateSettings> settings = plate_settings(r);
  Index steps = 0;
  for (const terrain::PlateSettings& s : settings) steps = std::max(steps, terrain::plate_steps(s));
  const std::size_t count = settings.size() * std::size_t(r.seeds);
  std::vector<terrain::PlateResult> results(count);
  Runs runs("plate", r, count, steps);
  runs([&](std::size_t k, const terrain::TestPace& pace) {
    results[k] = plate_test(seeded(r, k / settings.size()), settings[k % settings.size()], pace,
                            k + 1 == count ? scene : nullptr);
  });
  return results;
}

std::vector<terrain::ShearResult> run_shear(const SoilTestRequest& r, terrain::TestScene* scene) {
  const std::vector<Load> loads = loads_of(r);
  terrain::ShearSettings settings;
  settings.inertial_number = r.inertial_number.value_or(settings.inertial_number);
  if (r.quick) settings.travel = 2;
  std::vector<terrain::ShearResult> results(loads.size());
  Runs runs("shear", r, loads.size(), terrain::shear_steps(settings));
  runs([&](std::size_t k, const terrain::TestPace& pace) {
    terrain::ShearSettings own = settings;
    own.normal_stress = loads[k].stress;
    own.steps_per_time = steps_per_stress_time(own.normal_stress, own.steps_per_time, r);
    const terrain::TestSoil soil = seeded(r, loads[k].seed);
    results[k] = shear_test(terrain::test_bed(soil, 10, 6, 8, pace.threads), soil.laws(), own, pace,
                            k + 1 == loads.size() ? scene : nullptr);
  });
  return results;
}

SoilTestOutcome run_soil_test(const std::string& test, const SoilTestRequest& r) {
  terrain::check(r.soil);
  if (r.seeds < 1) throw InputError("soil test: at least one seed is needed");
  std::string names;
  for (const auto& known : kSoilTests) {
    if (test == known.name) return known.run(r);
    names += (names.empty() ? "" : ", ") + std::string(known.name);
  }
  throw InputError("soil test: \"" + test + "\" is none of " + names);
}

Json as_json(const SoilTestOutcome& o) {
  Json json = Json::Object{{"test", o.test}, {"soil", soil_json(o.request)}};
  if (o.repose) {
    json["angle_of_repose"] = angle_json(o.repose->angle);
    json["rest_speed_m_per_s"] = o.repose->rest_speed;
  }
  if (o.shear) add_strength(json, *o.shear);
  if (o.plate) add_bekker(json, *o.plate);
  if (o.cone) add_cone(json, *o.cone);
  if (o.triaxial) {
    add_strength(json, o.triaxial->strength);
    json["solid_fraction"] = o.triaxial->solid_fraction;
  }
  json["worst_rms_residual_m_per_s"] = o.worst_residual;
  return json;
}

std::string as_text(const SoilTestOutcome& o) {
  std::string text;
  if (o.repose) text += line("angle of repose: %.1f +- %.1f deg\n", o.repose->angle.degrees, o.repose->angle.error);
  if (o.shear) text += steady_text(*o.shear) + "\n" + peak_text(*o.shear) + "\n";
  if (o.plate) text += bekker_text(*o.plate) + "\n";
  if (o.cone) text += cone_text(*o.cone) + "\n";
  if (o.triaxial) {
    const terrain::TriaxialStrength& s = o.triaxial->strength;
    text += line(
        "steady: friction angle %.1f +- %.1f deg, cohesion %.0f Pa\npeak:   friction angle %.1f +- %.1f deg, "
        "cohesion %.0f Pa\nsolid fraction before shear %.3f\n",
        s.steady_angle.degrees, s.steady_angle.error, s.steady_cohesion, s.peak_angle.degrees, s.peak_angle.error,
        s.peak_cohesion, o.triaxial->solid_fraction);
  }
  return text + line("worst residual of a step, rms: %.2e m/s\n", o.worst_residual);
}

void write_soil_test(const std::filesystem::path& folder, const SoilTestOutcome& o, int threads) {
  create_folder(folder);
  write_file_atomically(folder / (o.test + ".csv"), o.csv);
  report::draw_line_plot(folder / (o.test + ".png"), o.plot);
  if (report::pictures_available()) draw_scene(folder / (o.test + "_bed.png"), o.plot.title, o.scene, threads);
  write_file_atomically(folder / (o.test + ".json"), as_json(o).dump(2) + "\n");
}

}  // namespace gonogo::inspect
