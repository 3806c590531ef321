#include <gonogo/terrain.h>

#include <cmath>

#include "base/files/shipped.h"
#include "pipeline/face/inside.h"
#include "terrain/bed/bed.h"
#include "terrain/soil/soil.h"

namespace gonogo::api {

struct Bed::Impl {
  terrain::Packing packing;
  BedSettings settings;
};
struct SoilTable::Impl {
  terrain::Calibration table;
};

namespace {

terrain::BedSpec spec_of(const BedSettings& s) {
  terrain::BedSpec spec;
  spec.length = s.length;
  spec.width = s.width;
  spec.depth = s.depth;
  spec.grain_diameter = s.grain_diameter;
  spec.size_spread = s.size_spread;
  spec.grain_density = s.grain_density;
  spec.settle_friction = s.settle_friction;
  spec.shape = terrain::grain_shape_of(s.grain_shape);
  spec.seed = s.seed;
  return spec;
}

BedSettings settings_of(const terrain::BedSpec& s) {
  return {.length = s.length,
          .width = s.width,
          .depth = s.depth,
          .grain_diameter = s.grain_diameter,
          .size_spread = s.size_spread,
          .grain_density = s.grain_density,
          .settle_friction = s.settle_friction,
          .grain_shape = terrain::name_of(s.shape),
          .seed = s.seed};
}

Bed bed_of(terrain::Packing packing) {
  const BedSettings settings = settings_of(packing.spec);
  return Bed(std::make_shared<Bed::Impl>(Bed::Impl{std::move(packing), settings}));
}

terrain::AngleMeaning meaning_of(const Soil& s) {
  return {.test = terrain::strength_test_of(s.test),
          .stage = s.residual ? terrain::Stage::residual : terrain::Stage::peak,
          .dilation = s.dilation};
}

terrain::MacroscopicSoil macroscopic(const Soil& s) {
  return {s.friction_angle, s.cohesion, s.bulk_density, s.relative_density, meaning_of(s)};
}

Soil soil_of(const terrain::MacroscopicSoil& s) {
  return {.friction_angle = s.friction_angle,
          .cohesion = s.cohesion,
          .bulk_density = s.bulk_density,
          .relative_density = s.relative_density};
}

/// `unit`: SI units of one unit of the file.
Range range_of(const terrain::SoilValue& value, double unit = 1) { return {value.low * unit, value.high * unit}; }

}  // namespace

Bed Bed::settle(const BedSettings& settings, int threads) {
  return guarded([&] { return bed_of(terrain::settle_packing(spec_of(settings), threads)); });
}
Bed Bed::read(const std::filesystem::path& file) {
  return guarded([&] { return bed_of(terrain::read_packing(file)); });
}
void Bed::write(const std::filesystem::path& file) const {
  guarded([&] { terrain::write_packing(file, impl_->packing); });
}
Bed Bed::shifted(std::uint64_t seed) const { return bed_of(terrain::shifted(impl_->packing, seed)); }
Bed Bed::tiled(int nx, int ny) const {
  return guarded([&] {
    if (nx < 1 || ny < 1) throw gonogo::InputError("bed: it takes one copy or more along each axis");
    return bed_of(terrain::tiled(impl_->packing, nx, ny));
  });
}

const BedSettings& Bed::settings() const { return impl_->settings; }
int Bed::grain_count() const { return int(impl_->packing.grain.size()); }
double Bed::solid_fraction() const { return impl_->packing.solid_fraction; }
double Bed::surface() const { return impl_->packing.surface; }
double Bed::highest_point() const { return terrain::highest_point(impl_->packing); }

World Bed::world(const ContactLaw& between_grains, const ContactLaw& grain_on_tool, double headroom) const {
  return guarded([&] {
    const terrain::BedLaws laws{law_of(between_grains), law_of(grain_on_tool)};
    return World(std::make_unique<World::Impl>(World::Impl{terrain::bed_world(impl_->packing, laws, headroom)}));
  });
}

StepSettings Bed::step_settings(double step, int iterations, double tolerance) const {
  const sim::StepSettings s = terrain::bed_step_settings(impl_->settings.grain_diameter, step, iterations, tolerance);
  return {.step = step,
          .iterations = iterations,
          .tolerance = tolerance,
          .envelope = s.envelope,
          .recovery_speed = s.recovery_speed,
          .cohesion_range = s.cohesion_range};
}

Soil as_triaxial(const Soil& soil) {
  return guarded([&] { return soil_of(terrain::as_triaxial(macroscopic(soil))); });
}

Soil SoilState::middle() const {
  return {.friction_angle = friction_angle.middle(),
          .cohesion = cohesion.middle(),
          .bulk_density = bulk_density.middle(),
          .relative_density = relative_density.middle(),
          .test = test,
          .residual = residual,
          .dilation = dilation};
}

std::vector<SoilState> read_soil(const std::string& name_or_file) {
  return guarded([&] {
    std::vector<SoilState> result;
    for (const terrain::SoilState& s :
         terrain::read_soil(shipped_file("soils", "soil", name_or_file, "calibration_")).states)
      result.push_back({.name = s.name,
                        .texture = s.texture,
                        .moisture = s.moisture,
                        .friction_angle = range_of(s.friction_angle),
                        .cohesion = range_of(s.cohesion, 1000),
                        .bulk_density = range_of(s.bulk_density),
                        .relative_density = range_of(s.relative_density),
                        .test = name_of(s.meaning.test),
                        .residual = s.meaning.stage == terrain::Stage::residual,
                        .dilation = s.meaning.dilation});
    return result;
  });
}

SoilTable SoilTable::read(const std::string& name_or_file) {
  return guarded([&] {
    const auto file = shipped_file("soils", "calibration", name_or_file);
    return SoilTable(std::make_shared<Impl>(Impl{terrain::read_calibration(file)}));
  });
}

double SoilTable::grain_diameter() const { return impl_->table.grain_diameter; }
Range SoilTable::friction_angles() const {
  const terrain::AngleRange angles = terrain::reachable_angles(impl_->table);
  return {angles.lowest, angles.highest};
}

SoilGrains SoilTable::grains(const Soil& soil) const {
  return guarded([&] {
    const terrain::SoilFit fit = terrain::fit_soil(impl_->table, macroscopic(soil));
    SoilGrains result;
    result.law = {fit.law.friction, fit.law.rolling_friction, fit.law.cohesion_pressure};
    result.bed.grain_diameter = impl_->table.grain_diameter;
    result.bed.grain_density = fit.grain_density;
    result.bed.settle_friction = impl_->table.packing[fit.packing].settle_friction;
    result.bed.grain_shape = terrain::name_of(impl_->table.shape);
    result.reached = {.friction_angle = fit.friction_angle,
                      .cohesion = fit.cohesion,
                      .bulk_density = fit.bulk_density,
                      .relative_density = fit.relative_density};
    result.friction_angle_error = fit.friction_angle_error;
    result.cohesion_error = fit.cohesion_error;
    return result;
  });
}

std::string usda_texture(double sand, double silt, double clay) {
  if (!(sand >= 0 && silt >= 0 && clay >= 0) || !(std::abs(sand + silt + clay - 100) < 0.5))
    throw InputError("usda_texture: sand, silt and clay are shares in percent that add up to 100");
  return terrain::usda_texture(sand, silt, clay);
}
double cone_index(const Soil& soil) {
  const Soil s = as_triaxial(soil);
  return terrain::cone_index(s.cohesion, s.friction_angle);
}

}  // namespace gonogo::api
