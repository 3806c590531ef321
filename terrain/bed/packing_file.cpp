// Packings on disk: one HDF5 file each, named by the hash of the specification that made it.
#include "base/error.h"
#include "base/hdf5/hdf5.h"
#include "base/progress.h"
#include "terrain/bed/bed.h"

namespace gonogo::terrain {
namespace {

void write_grains(Hdf5Writer& out, const std::string& name, const std::vector<Grain>& grains) {
  std::vector<double> rows;
  for (const Grain& g : grains) rows.insert(rows.end(), {g.position.x, g.position.y, g.position.z, g.radius});
  out.array(name, rows, {grains.size(), 4});
  out.attribute(name, "columns", std::vector<std::string>{"x", "y", "z", "radius"});
  out.attribute(name, "unit", "m");
}

std::vector<Grain> read_grains(const Hdf5Reader& in, const std::string& name) {
  const auto shape = in.shape(name);
  if (shape.size() != 2 || shape[1] != 4)
    in.fail(name, "expected four columns; remove the file, it will be made again");
  const auto rows = in.array<double>(name);
  std::vector<Grain> grains;
  for (std::size_t i = 0; i + 3 < rows.size(); i += 4)
    grains.push_back({{rows[i], rows[i + 1], rows[i + 2]}, rows[i + 3]});
  return grains;
}

}  // namespace

void write_packing(const std::filesystem::path& path, const Packing& packing) {
  Hdf5Writer out;
  const BedSpec& s = packing.spec;
  write_grains(out, "grain", packing.grain);
  write_grains(out, "base", packing.base);
  out.array("spec", std::vector<double>{s.length, s.width, s.depth, s.grain_diameter, s.size_spread, s.grain_density,
                                        s.settle_friction, double(s.seed)});
  out.array("measured", std::vector<double>{packing.surface, packing.solid_fraction, packing.residual_speed});
  out.attribute("measured", "columns",
                std::vector<std::string>{"surface [m]", "solid_fraction [-]", "residual_speed [m/s]"});
  out.save(path);
}

Packing read_packing(const std::filesystem::path& path) {
  const Hdf5Reader in(path);
  const auto s = in.array<double>("spec", gonogo::Shape{8});
  const auto measured = in.array<double>("measured", gonogo::Shape{3});
  Packing p;
  p.spec = {s[0], s[1], s[2], s[3], s[4], s[5], s[6], std::uint64_t(s[7])};
  p.grain = read_grains(in, "grain");
  p.base = read_grains(in, "base");
  p.surface = measured[0], p.solid_fraction = measured[1], p.residual_speed = measured[2];
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
  const Packing packing = settle_packing(spec, threads);
  write_packing(path, packing);
  return packing;
}

}  // namespace gonogo::terrain
