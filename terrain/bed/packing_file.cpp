// Packings on disk: one HDF5 file each, named by the hash of the specification that made it.
#include "base/error.h"
#include "base/format.h"
#include "base/hdf5/hdf5.h"
#include "base/progress.h"
#include "terrain/bed/bed.h"

namespace gonogo::terrain {
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
  const auto path = packing_path(spec, folder);
  if (std::filesystem::exists(path)) {
    try {
      return read_packing(path);
    } catch (const InputError& e) {
      log_line("bed", std::string(e.what()) + "; settling it again");
    }
  }
  Packing packing = settle_packing(spec, threads);
  write_packing(path, packing);
  return packing;
}

}  // namespace gonogo::terrain
