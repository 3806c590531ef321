#include "terrain/bed/bed.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/hdf5/hdf5.h"
#include "base/json/json.h"
#include "base/math/random.h"
#include "base/progress.h"
#include "base/units.h"
#include "sim/law/contact_law.h"
#include "sim/scene/penalty_setup.h"

namespace gonogo::terrain {

namespace {

using sim::SceneWorld;

/// Streams of random numbers, one per use.
enum Stream : std::uint64_t { radius_stream = 1, place_stream, speed_stream, base_stream, shift_stream, turn_stream };

double uniform(std::uint64_t seed, Stream stream, std::uint64_t index) { return random_unit(seed, stream, index); }

/// Random for clumps.
Quat first_orientation(const BedSpec& s, std::size_t grain) {
  if (s.shape == GrainShape::sphere) return {};
  const auto u = [&](std::uint64_t k) { return uniform(s.seed, turn_stream, 3 * grain + k); };
  return random_orientation(u(0), u(1), u(2));
}

constexpr std::size_t kBaseTurns = std::size_t(1) << 40;  // glued grains draw their orientations from here on

/// Fixed grains on a square lattice about one diameter apart, heights varied by a quarter of a diameter. A clump has a
/// sphere in it that closes the holes between its lobes and its neighbours'.
std::vector<Grain> glued_base(const BedSpec& s) {
  const int nx = std::max(1, int(s.length / s.grain_diameter)), ny = std::max(1, int(s.width / s.grain_diameter));
  std::vector<Grain> base;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const auto site = std::size_t(j) * std::size_t(nx) + std::size_t(i);
      const double bump = 0.25 * s.grain_diameter * uniform(s.seed, base_stream, site);
      const Grain g{{(i + 0.5) * s.length / nx, (j + 0.5) * s.width / ny, bump - s.grain_diameter / 2},
                    s.grain_diameter / 2,
                    first_orientation(s, kBaseTurns + site)};
      base.push_back({g.position, g.radius});
      if (s.shape == GrainShape::sphere) continue;
      for (const Grain& lobe : lobes_of(s.shape, {g})) base.push_back(lobe);
    }
  return base;
}

/// Staggered loose layers above the base, enough to fill the depth at a solid fraction of 0.6.
std::vector<Grain> poured_grains(const BedSpec& s) {
  const double volume = kPi / 6 * std::pow(s.grain_diameter, 3) * (1 + s.size_spread * s.size_spread);
  const auto count = std::size_t(0.6 * s.length * s.width * s.depth / volume);
  const double pitch = 1.05 * clump_of(s.shape, s.grain_diameter).reach * (1 + s.size_spread);
  const int nx = int(s.length / pitch), ny = int(s.width / pitch);
  std::vector<Grain> grains;
  for (std::size_t k = 0; k < count; ++k) {
    const int layer = int(k / (std::size_t(nx) * ny)), row = int(k / nx) % ny, column = int(k) % nx;
    const double stagger = layer % 2 ? 0.5 : 0.0;
    const double radius = s.grain_diameter / 2 * (1 + s.size_spread * (2 * uniform(s.seed, radius_stream, k) - 1));
    grains.push_back({{(column + stagger) * s.length / nx, (row + stagger) * s.width / ny,
                       s.grain_diameter + layer * pitch + 0.02 * pitch * uniform(s.seed, place_stream, k)},
                      radius,
                      first_orientation(s, k)});
  }
  return grains;
}

/// Solid volume of a sphere below height z.
double volume_below(const Grain& g, double z) {
  const double h = std::clamp(z - (g.position.z - g.radius), 0.0, 2 * g.radius);
  return kPi * h * h * (g.radius - h / 3);
}

/// Where lobes overlap each counts for its share of the union. `lobes`: of grains of this shape.
double solid_fraction_between(const std::vector<Grain>& lobes, const BedSpec& s, double low, double high) {
  const Clump c = clump_of(s.shape, 1);
  const double sphere = kPi * 4 / 3 * c.lobe_radius * c.lobe_radius * c.lobe_radius;
  const double share = c.lobe.size() == 1 ? 1 : c.volume / (sphere * double(c.lobe.size()));
  double solid = 0;
  for (const Grain& g : lobes) solid += volume_below(g, high) - volume_below(g, low);
  return share * solid / (s.length * s.width * (high - low));
}

double rms_speed(const std::vector<sim::BodyState>& bodies, std::size_t count) {
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += dot(bodies[i].velocity, bodies[i].velocity);
  return std::sqrt(sum / double(count));
}

/// At rest, grains move less than a thousandth of their diameter in the time they need to fall through it [m/s].
double quiet_speed(const BedSpec& s) { return 1e-2 * std::sqrt(kGravity * s.grain_diameter); }

void check(const BedSpec& s) {
  if (!(s.grain_diameter > 0) || !(s.size_spread >= 0 && s.size_spread < 0.5))
    throw InputError("bed: the grain diameter must be above zero and the size spread between 0 and 0.5");
  const double shortest = 4 * s.grain_diameter * (1 + s.size_spread);
  if (s.length < shortest || s.width < shortest || s.depth < 2 * s.grain_diameter)
    throw InputError(
        "bed: at least four grains long and wide and two deep are needed; use a larger bed or smaller grains");
}

SceneWorld pouring_world(const BedSpec& s, const std::vector<Grain>& grains, const std::vector<Grain>& base) {
  Packing loose{.spec = s, .grain = grains, .base = base};
  loose.surface = grains.back().position.z;
  const sim::PairLaw slippery{Real(s.settle_friction), Real(s.settle_rolling), 0};
  SceneWorld world = bed_world(loose, {slippery, slippery}, s.grain_diameter);
  for (std::size_t i = 0; i < grains.size(); ++i)
    world.body[i].velocity = {Real(uniform(s.seed, speed_stream, 3 * i) - 0.5),
                              Real(uniform(s.seed, speed_stream, 3 * i + 1) - 0.5),
                              Real(uniform(s.seed, speed_stream, 3 * i + 2) - 1)};
  return world;
}

}  // namespace

std::string BedSpec::hash() const {
  Json j;
  j["maker"] = "settle_packing/5";
  j["length"] = length;
  j["width"] = width;
  j["depth"] = depth;
  j["grain_diameter"] = grain_diameter;
  j["size_spread"] = size_spread;
  j["grain_density"] = grain_density;
  j["settle_friction"] = settle_friction;
  j["settle_rolling"] = settle_rolling;
  j["seed"] = std::uint64_t(seed);
  j["shape"] = name_of(shape);
  if (settled_on == sim::Backend::cuda) j["settled_on"] = "cuda";
  return content_hash(j.dump());
}

sim::StepSettings bed_step_settings(double grain_diameter, double step, int iterations, double tolerance) {
  sim::StepSettings s;
  s.step = Real(step);
  s.iterations = iterations;
  s.tolerance = Real(tolerance);
  s.envelope = Real(0.025 * grain_diameter);
  s.cohesion_range = Real(0.01 * grain_diameter);
  s.recovery_speed = Real(std::sqrt(kGravity * grain_diameter) / 10);
  return s;
}

sim::SceneWorld bed_world(const Packing& packing, const BedLaws& laws, double headroom) {
  const BedSpec& s = packing.spec;
  SceneWorld world;
  world.origin = {0, 0, -2 * s.grain_diameter};
  world.size = {s.length, s.width, packing.surface + headroom + 2 * s.grain_diameter};
  world.periodic_x = world.periodic_y = true;
  world.set_law(grain_material, grain_material, laws.grain);
  world.set_law(grain_material, base_material, laws.grain);
  world.set_law(grain_material, tool_material, laws.tool);
  world.set_law(base_material, tool_material, laws.tool);
  for (const Grain& g : packing.grain) add_grain(world, s.shape, g, s.grain_density, grain_material);
  const sim::BodyIndex base = world.add_body({}, sim::fixed_body());
  for (const Grain& g : packing.base) {
    sim::Shape shape;
    shape.body = base;
    shape.material = base_material;
    shape.offset_B = static_cast<Vec3>(g.position);
    shape.size = {Real(g.radius), 0, 0};
    world.add_shape(shape);
  }
  return world;
}

namespace {

/// A packing on its way: its world takes up where its grains are after each part of the settling.
struct Settling {
  Packing packing;
  SceneWorld world;
  bool quiet() const { return packing.residual_speed < quiet_speed(packing.spec); }
};

/// Lets the worlds' grains move until they are quiet, each of them on its own clock: 500 to 100 `max_batches` steps.
/// Tells `at_rest` how many of them are.
void let_settle(const std::vector<Settling*>& beds, int iterations, int max_batches, int threads,
                const std::function<void(std::size_t)>& at_rest) {
  const BedSpec& spec = beds.front()->packing.spec;
  const auto settings = bed_step_settings(spec.grain_diameter, 1e-3, iterations);
  sim::Scene scene;
  for (const Settling* bed : beds) scene.push_back(bed->world);
  const auto simulation = sim::make_simulation(spec.settled_on, scene, settings, threads);
  std::vector<bool> done(beds.size());
  for (int k = 1; k <= max_batches && std::find(done.begin(), done.end(), false) != done.end(); ++k) {
    stop_if_cancelled();
    simulation->advance(100);
    for (std::size_t w = 0; w < beds.size(); ++w) {
      if (done[w]) continue;
      if (const sim::StepReport report = simulation->report(sim::WorldIndex(w)); report.flags != 0)
        throw DeviceError("bed: settling failed: " + sim::description(report.fault, settings.step));
      Settling& bed = *beds[w];
      const auto bodies = simulation->bodies(sim::WorldIndex(w));
      bed.packing.residual_speed = rms_speed(bodies, bed.packing.grain.size());
      done[w] = k == max_batches || (k > 4 && bed.quiet());
      if (done[w])
        std::copy(bodies.begin(), bodies.begin() + std::ptrdiff_t(bed.world.body.size()), bed.world.body.begin());
    }
    std::size_t resting = 0;
    for (std::size_t w = 0; w < beds.size(); ++w) resting += done[w] && beds[w]->quiet();
    at_rest(resting);
  }
}

Settling poured(const BedSpec& spec) {
  const std::vector<Grain> grains = poured_grains(spec);
  const Packing packing{.spec = spec, .grain = grains, .base = glued_base(spec)};
  return {packing, pouring_world(spec, grains, packing.base)};
}

/// What the grains at rest make of the packing.
void measure(Settling& bed) {
  Packing& p = bed.packing;
  const BedSpec& s = p.spec;
  take_places(p.grain, s.shape, bed.world.body);
  const std::vector<Grain> lobes = lobes_of(p);
  p.surface = surface_height(lobes, s.length, s.width, s.grain_diameter);
  p.solid_fraction = solid_fraction_between(lobes, s, s.grain_diameter, p.surface - s.grain_diameter);
}

}  // namespace

std::vector<Packing> settle_packings(const std::vector<BedSpec>& specs, int threads,
                                     const std::function<void(std::size_t)>& at_rest) {
  std::vector<Settling> beds;
  for (const BedSpec& spec : specs) {
    check(spec);
    if (spec.settled_on != specs[0].settled_on || spec.grain_diameter != specs[0].grain_diameter ||
        spec.shape != specs[0].shape)
      throw InputError("beds: packings settled together must be of the same grains on the same device");
    beds.push_back(poured(spec));
  }
  std::vector<Settling*> restless;
  for (Settling& bed : beds) restless.push_back(&bed);
  // Long beds of slippery grains keep flowing on what so few updates leave unsolved; so do clumps, once they have
  // fallen.
  const auto settle = [&](int iterations, int max_batches) {
    const std::size_t before = beds.size() - restless.size();
    let_settle(restless, iterations, max_batches, threads, [&](std::size_t resting) {
      if (at_rest) at_rest(before + resting);
    });
    std::erase_if(restless, [](const Settling* bed) { return bed->quiet(); });
  };
  if (!specs.empty()) settle(40, specs[0].shape == GrainShape::sphere ? 20 : 10);
  if (!restless.empty()) settle(200, 40);
  std::vector<Packing> packings;
  for (Settling& bed : beds) {
    if (!bed.quiet())
      throw DeviceError("bed: the grains did not come to rest (still " + number_text(bed.packing.residual_speed) +
                        " m/s)");
    measure(bed);
    packings.push_back(std::move(bed.packing));
  }
  return packings;
}

Packing settle_packing(const BedSpec& spec, int threads) { return settle_packings({spec}, threads).front(); }

std::vector<Grain> lobes_of(const Packing& packing) {
  const BedSpec& s = packing.spec;
  std::vector<Grain> lobes = lobes_of(s.shape, packing.grain);
  for (Grain& g : lobes) {
    g.position.x -= s.length * std::floor(g.position.x / s.length);
    g.position.y -= s.width * std::floor(g.position.y / s.width);
  }
  return lobes;
}

double highest_point(const Packing& packing) {
  double top = 0;
  for (const Grain& g : lobes_of(packing.spec.shape, packing.grain)) top = std::max(top, g.position.z + g.radius);
  return top;
}

double surface_height(const std::vector<Grain>& spheres, double length, double width, double column) {
  const int nx = std::max(1, int(length / column)), ny = std::max(1, int(width / column));
  std::vector<double> top(std::size_t(nx) * ny, 0.0);
  for (const Grain& g : spheres) {
    const int i = std::clamp(int(g.position.x / length * nx), 0, nx - 1);
    const int j = std::clamp(int(g.position.y / width * ny), 0, ny - 1);
    double& highest = top[std::size_t(j) * nx + i];
    highest = std::max(highest, g.position.z + g.radius);
  }
  double sum = 0;
  for (const double z : top) sum += z;
  return sum / double(top.size());
}

Packing shifted(const Packing& packing, std::uint64_t seed) {
  Packing result = packing;
  const BedSpec& s = packing.spec;
  const double dx = uniform(seed, shift_stream, 0) * s.length, dy = uniform(seed, shift_stream, 1) * s.width;
  const bool mirror = uniform(seed, shift_stream, 2) < 0.5;
  const auto move = [&](Grain& g) {
    g.position.x = std::fmod(g.position.x + dx, s.length);
    g.position.y = std::fmod((mirror ? s.width - g.position.y : g.position.y) + dy, s.width);
    if (mirror) g.orientation = mirrored(s.shape, g.orientation);
  };
  for (Grain& g : result.grain) move(g);
  for (Grain& g : result.base) move(g);
  return result;
}

Packing tiled(const Packing& tile, int nx, int ny) {
  if (nx < 1 || ny < 1) throw InputError("a bed needs at least one tile along and across");
  Packing bed = tile;
  bed.spec.length *= nx;
  bed.spec.width *= ny;
  bed.grain.clear();
  bed.base.clear();
  const auto copy = [&](const std::vector<Grain>& from, std::vector<Grain>& to) {
    for (int i = 0; i < nx; ++i)
      for (int j = 0; j < ny; ++j)
        for (const Grain& g : from)
          to.push_back({g.position + Vec3d{i * tile.spec.length, j * tile.spec.width, 0}, g.radius, g.orientation});
  };
  copy(tile.grain, bed.grain);
  copy(tile.base, bed.base);
  return bed;
}

namespace {

constexpr std::size_t kColumns = 8, kSpecNumbers = 11;

void write_grains(Hdf5Writer& out, const std::string& name, const std::vector<Grain>& grains) {
  std::vector<double> rows;
  for (const Grain& g : grains) {
    const Quat& q = g.orientation;
    rows.insert(rows.end(), {g.position.x, g.position.y, g.position.z, g.radius, q.w, q.x, q.y, q.z});
  }
  out.array(name, rows, {grains.size(), kColumns});
  out.attribute(name, "columns",
                std::vector<std::string>{"x [m]", "y [m]", "z [m]", "radius [m]", "orientation w", "x", "y", "z"});
}

std::vector<Grain> read_grains(const Hdf5Reader& in, const std::string& name) {
  const auto shape = in.shape(name);
  if (shape.size() != 2 || shape[1] != kColumns)
    in.fail(name, "expected eight columns; remove the file, it will be made again");
  const auto rows = in.array<double>(name);
  std::vector<Grain> grains;
  for (std::size_t i = 0; i + kColumns <= rows.size(); i += kColumns)
    grains.push_back({{rows[i], rows[i + 1], rows[i + 2]},
                      rows[i + 3],
                      {Real(rows[i + 4]), Real(rows[i + 5]), Real(rows[i + 6]), Real(rows[i + 7])}});
  return grains;
}

}  // namespace

void write_packing(const std::filesystem::path& path, const Packing& packing) {
  Hdf5Writer out;
  const BedSpec& s = packing.spec;
  write_grains(out, "grain", packing.grain);
  write_grains(out, "base", packing.base);
  out.array("spec", std::vector<double>{s.length, s.width, s.depth, s.grain_diameter, s.size_spread, s.grain_density,
                                        s.settle_friction, s.settle_rolling, double(s.seed), double(s.shape),
                                        double(s.settled_on)});
  out.attribute("spec", "shapes", grain_shape_names());
  out.array("measured", std::vector<double>{packing.surface, packing.solid_fraction, packing.residual_speed});
  out.attribute("measured", "columns",
                std::vector<std::string>{"surface [m]", "solid_fraction [-]", "residual_speed [m/s]"});
  out.save(path);
}

Packing read_packing(const std::filesystem::path& path) {
  const Hdf5Reader in(path);
  const auto s = in.array<double>("spec", gonogo::Shape{kSpecNumbers});
  const auto measured = in.array<double>("measured", gonogo::Shape{3});
  Packing p;
  if (!(s[9] >= 0 && s[9] < double(grain_shape_names().size())))
    in.fail("spec", "the shape of the grains is " + number_text(s[9]) + ", allowed are 0 to 2; remove the file");
  p.spec = {.length = s[0],
            .width = s[1],
            .depth = s[2],
            .grain_diameter = s[3],
            .size_spread = s[4],
            .grain_density = s[5],
            .settle_friction = s[6],
            .settle_rolling = s[7],
            .seed = std::uint64_t(s[8]),
            .shape = GrainShape(int(s[9])),
            .settled_on = s[10] == 0 ? sim::Backend::cpu : sim::Backend::cuda};
  p.grain = read_grains(in, "grain");
  p.base = read_grains(in, "base");
  p.surface = measured[0];
  p.solid_fraction = measured[1];
  p.residual_speed = measured[2];
  return p;
}

std::filesystem::path packing_path(const BedSpec& spec, const std::filesystem::path& folder) {
  return folder / ("packing-" + spec.hash() + ".h5");
}

Packing cached_packing(const BedSpec& spec, const std::filesystem::path& folder, int threads) {
  static std::mutex files;  // the HDF5 library serves one thread at a time
  const auto path = packing_path(spec, folder);
  if (std::filesystem::exists(path)) {
    try {
      const std::lock_guard lock(files);
      return read_packing(path);
    } catch (const InputError& e) {
      log_line("bed", std::string(e.what()) + "; settling it again");
    }
  }
  Packing packing = settle_packing(spec, threads);
  const std::lock_guard lock(files);
  write_packing(path, packing);
  return packing;
}

Numerics usual_numerics(double grain_diameter) {
  const double size = grain_diameter / 0.032;
  Numerics n{.step = std::min(1e-3 * size, 2e-3), .iterations = 1, .tolerance = 0, .target = sim::Target::coulomb};
  n.substeps = int(std::lround(n.step / (25e-6 * size)));
  n.give = 0.6;
  return n;
}

sim::StepSettings step_settings(double grain_diameter, const Numerics& n) {
  sim::StepSettings s = bed_step_settings(grain_diameter, n.step, n.iterations, n.tolerance);
  s.substeps = n.substeps;
  s.target = n.target;
  s.give = Real(n.give);
  if (!sim::is_penalty(n.contact)) return s;
  s.contact = n.contact;
  s.penalty =
      sim::law_of_overlap(n.overlap, kOverlapSpeed, grain_diameter / 2, BedSpec{}.grain_density, kPenaltyRestitution);
  return s;
}

std::string description(const Numerics& n) {
  if (sim::is_penalty(n.contact))
    return line("step %g s, %s, overlaps to %g of a radius", n.step, sim::name_of(n.contact), n.overlap);
  return line("step %g s, %d x %d updates to %g m/s%s", n.step, n.substeps, n.iterations, n.tolerance,
              n.target == sim::Target::coulomb ? ", coulomb" : "") +
         (n.give > 0 ? line(", give %g", n.give) : "");
}

void write_numerics(Json& object, const Numerics& n) {
  object["step_s"] = n.step;
  object["substeps"] = n.substeps;
  object["iterations"] = n.iterations;
  object["tolerance_m_per_s"] = n.tolerance;
  if (n.target != sim::Target::ccp) object["target"] = sim::name_of(n.target);
  if (n.give > 0) object["give"] = n.give;
  if (!sim::is_penalty(n.contact)) return;
  object["contact"] = sim::name_of(n.contact);
  object["overlap"] = n.overlap;
}

bool states_numerics(const Json& object) {
  if (!object.is_object()) return false;
  for (const char* key : {"step_s", "substeps", "iterations", "tolerance_m_per_s"})
    if (!object.find(key)) return false;
  return true;
}

Numerics read_numerics(const Json& object) {
  Numerics n;
  n.step = object.at("step_s").number();
  n.substeps = int(object.at("substeps").integer());
  n.iterations = int(object.at("iterations").integer());
  n.tolerance = object.at("tolerance_m_per_s").number();
  if (const Json* target = object.find("target")) n.target = sim::target_named(target->string());
  if (const Json* give = object.find("give")) n.give = give->number();
  if (const Json* contact = object.find("contact")) n.contact = sim::contact_named(contact->string());
  if (const Json* overlap = object.find("overlap")) n.overlap = overlap->number();
  return n;
}

Packing on_hard_layer(const Packing& packing, double depth) {
  const double d = packing.spec.grain_diameter, top = packing.surface - depth;
  if (top < d / 2) return packing;
  Packing bed = packing;
  bed.grain.clear();
  bed.base.clear();
  const double lowest = -2 * d * (1 + packing.spec.size_spread);  // two grains thick: no grain above finds a hole
  const auto lowered = [&](Grain g) {
    g.position.z -= top;
    if (g.position.z >= 0)
      bed.grain.push_back(g);
    else if (g.position.z > lowest)
      for (const Grain& lobe : lobes_of(packing.spec.shape, {g})) bed.base.push_back(lobe);
  };
  for (const Grain& g : packing.grain) lowered(g);
  for (Grain g : packing.base) {  // glued already
    g.position.z -= top;
    if (g.position.z > lowest) bed.base.push_back(g);
  }
  bed.surface = depth;
  bed.spec.depth = depth;
  return bed;
}

void check_patch(const MovingPatch& patch, double grain_diameter) {
  const double slab = patch.length - 2 * patch.reach;
  if (!(slab >= 4 * grain_diameter))
    throw InputError("a bed of " + number_text(patch.length, 5) +
                     " m is too short for a moving patch: the vehicle needs " + number_text(2 * patch.reach, 5) +
                     " m and a slab of four grains; make the bed longer");
}

std::vector<GrainPlace> grain_places(const std::vector<sim::BodyState>& bodies, GrainShape shape, std::size_t count) {
  std::vector<Grain> grains(count);
  take_places(grains, shape, bodies);
  std::vector<GrainPlace> places;
  for (const Grain& g : grains) places.push_back({g.position, g.orientation});
  return places;
}

std::vector<sim::BodyIndex> virgin_grains(const MovingPatch& patch, const std::vector<GrainPlace>& start, double x) {
  std::vector<sim::BodyIndex> virgin;
  for (std::size_t i = 0; i < start.size(); ++i) {
    const double way = (start[i].position.x - x) / patch.length;  // periods; the nearest image is half of one away
    if (std::fabs(way - std::floor(way + 0.5)) * patch.length > patch.reach) virgin.push_back(sim::BodyIndex(i));
  }
  return virgin;
}

void renew_ground(sim::Simulation& simulation, sim::WorldIndex world, const MovingPatch& patch,
                  const std::vector<GrainPlace>& start, double x) {
  const std::vector<sim::BodyIndex> virgin = virgin_grains(patch, start, x);
  std::vector<sim::BodyState> states;
  for (const sim::BodyIndex i : virgin)
    states.push_back({start[std::size_t(i)].position, start[std::size_t(i)].orientation, {}, {}});
  simulation.set_bodies(world, virgin, states);
}

}  // namespace gonogo::terrain
