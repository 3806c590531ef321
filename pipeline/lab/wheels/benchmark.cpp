#include "pipeline/lab/wheels/benchmark.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/files/csv.h"
#include "base/files/shipped.h"
#include "base/format.h"
#include "base/units.h"
#include "pipeline/lab/wheels/agreement.h"

namespace gonogo::lab {

bool Benchmark::leads(Quantity q) const { return std::find(led.begin(), led.end(), q) != led.end(); }

std::vector<Quantity> Benchmark::measured() const {
  std::map<Quantity, bool> seen;
  for (const BenchmarkPoint& p : point)
    for (const auto& [quantity, value] : p.measured) seen[quantity] = true;
  std::vector<Quantity> all;
  for (const auto& [quantity, yes] : seen) all.push_back(quantity);
  return all;
}

double Benchmark::scatter_at(const BenchmarkPoint& p, Quantity q) const {
  const auto stated = scatter.find(q);
  const Measured& m = p.measured.at(q);
  const double of_repeats = std::max(m.high - m.mean, m.mean - m.low);
  return std::max(of_repeats, stated == scatter.end() ? 0 : stated->second);
}

void choose_state(Benchmark& b, const std::string& state) {
  if (state.empty()) return;
  std::vector<std::string> names;
  for (const terrain::SoilState& s : terrain::read_soil(b.soil_path).states) {
    names.push_back(s.name);
    if (s.name != state) continue;
    b.soil = s;
    return;
  }
  throw InputError(b.soil_path.string() + ": no state \"" + state + "\"; it has: " + join_words(names));
}

namespace fs = std::filesystem;
namespace {

constexpr const char* kKind = "benchmarks";

/// What a benchmark names: a file beside it, or one that ships.
fs::path named_file(const Config& c, const std::string& key, const std::string& kind, const std::string& what) {
  fs::path beside = c.path(key);
  if (fs::is_regular_file(beside)) return beside;
  try {
    return shipped_file(kind, what, c.text(key));
  } catch (const InputError& error) {
    c.fail(key, error.what());
  }
}

void need_source(const Config& c) {
  if (c.text_or("source", "").empty() == c.text_or("no_source", "").empty())
    c.fail("", "needs a \"source\", or \"no_source\" that says why the numbers are what they are");
}

Assumed read_assumed(const Config& c, Range allowed) {
  Assumed a;
  a.value = a.low = a.high = c.number("value", allowed);
  if (c.has("range")) {
    const std::vector<double> range = c.numbers("range", allowed);
    if (range.size() != 2 || !(range[0] <= a.value && a.value <= range[1]))
      c.fail("range", "needs two numbers, the lower one first, with the value between them");
    a.low = range[0];
    a.high = range[1];
  }
  need_source(c);
  c.finish();
  return a;
}

/// A wheel by itself gets the quarter of configs/vehicles/mgru3_wheel.json in proportion: half of the mass at the hub,
/// a spring that sags by 0.08 radii, damped to 0.7 of critical, and a torque that never limits.
vehicle::Vehicle quarter_of_wheel(const Config& c, const std::string& name, double load) {
  const double mass = load / kGravity, sprung = mass / 2;
  vehicle::Wheel wheel;
  wheel.name = "wheel";
  wheel.radius = c.number("radius_m", {0.01, 5});
  wheel.width = c.number("width_m", {0.005, 3});
  wheel.lug_count = int(c.integer_or("lug_count", 0, {0, 200}));
  wheel.lug_height = wheel.lug_count > 0 ? c.number("lug_height_m", {1e-4, 0.5}) : 0;
  wheel.lug_thickness = wheel.lug_count > 0 ? c.number("lug_thickness_m", {1e-4, 0.5}) : 0.001;
  c.finish();
  const double radius = wheel.radius, stiffness = sprung * kGravity / (0.08 * radius);
  wheel.part = {.name = wheel.name, .mass = mass / 2, .moments = {0, 0.45 * mass * radius * radius, 0}};
  vehicle::Vehicle v = vehicle::quarter_vehicle(
      name, std::move(wheel), {stiffness, 2 * 0.7 * std::sqrt(stiffness * sprung)}, sprung, 10 * load * radius);
  v.length = 2.5 * radius;
  v.clearance = radius;
  return v;
}

double least_load(const Benchmark& b, const Config& c) {
  if (b.load > 0) return b.load;
  double least = std::numeric_limits<double>::infinity();
  for (const BenchmarkPoint& p : b.point) {
    const auto own = p.led.find(Quantity::load);
    if (own == p.led.end()) c.fail("load_N", "missing; give the load on the wheel here or in a column load_N");
    least = std::min(least, own->second);
  }
  if (!(least > 0)) c.fail("points", "column load_N holds " + number_text(least) + " N; loads are above 0");
  return least;
}

void read_mover(const Config& c, Benchmark& b) {
  if (c.has("wheel") == c.has("vehicle")) c.fail("", "needs either \"wheel\" or \"vehicle\"");
  const bool by_point = !b.point.empty() && b.point.front().led.count(Quantity::load) > 0;
  if (c.has("load_N")) {
    if (by_point) c.fail("load_N", "stands here and in a column load_N; give one of them");
    b.load = c.number("load_N", {0.1, 1e6});
  }
  if (c.has("wheel")) {
    b.vehicle = quarter_of_wheel(c.object("wheel"), b.name, least_load(b, c));
    return;
  }
  if (b.load > 0 || by_point) c.fail("vehicle", "has its own weight; give no load_N, or a \"wheel\" in its place");
  b.vehicle_file = named_file(c, "vehicle", "vehicles", "vehicle");
  b.vehicle = vehicle::read_any_vehicle(b.vehicle_file);
  if (is_whole(b) && b.leads(Quantity::slip_angle))
    c.fail("led",
           "slip_angle of a whole vehicle; a carriage turns one wheel: name a vehicle of kind quarter or a wheel");
  if (is_whole(b) && b.leads(Quantity::slip))
    c.fail("led", "slip of a whole vehicle; a carriage leads one wheel: name a vehicle of kind quarter or a wheel");
}

void read_soil_state(const Config& soil, Benchmark& b) {
  b.soil_path = named_file(soil, "file", "soils", "soil");
  b.soil_file = b.soil_path.stem().string();
  const std::string state = soil.text("state");
  try {
    choose_state(b, state);
  } catch (const InputError& error) {
    soil.fail("state", error.what());
  }
  soil.finish();
}

void read_led(const Config& c, Benchmark& b) {
  for (const std::string& name : c.texts("led")) b.led.push_back(quantity_named(name, c, "led"));
  const bool slope = b.leads(Quantity::slope), slip = b.leads(Quantity::slip);
  const std::size_t known = std::size_t(slope) + std::size_t(slip) + std::size_t(b.leads(Quantity::slip_angle));
  if (slope == slip || known != b.led.size() || (slope && b.led.size() > 1))
    c.fail("led", "needs slope, or slip with or without slip_angle");
}

/// Keeps the points inside the span that is judged.
void read_judged(const Config& c, Benchmark& b) {
  const auto judged = c.object_if("judged");
  if (!judged) return;
  judged->text("why");
  for (const Quantity q : b.led) {
    if (!judged->has(name_of(q))) continue;
    const std::vector<double> span = judged->numbers(name_of(q));
    if (span.size() != 2) judged->fail(name_of(q), "needs two numbers, the lower one first");
    std::erase_if(b.point, [&](const BenchmarkPoint& p) { return p.led.at(q) < span[0] || p.led.at(q) > span[1]; });
  }
  judged->finish();
  if (b.point.empty()) c.fail("judged", "leaves no point");
}

void read_scatter(const Config& c, Benchmark& b) {
  const auto scatter = c.object_if("scatter");
  if (!scatter) return;
  for (const Quantity q : b.measured())
    if (scatter->has(column_of(q))) b.scatter[q] = scatter->number(column_of(q), {0, 1e9});
  need_source(*scatter);
  scatter->finish();
}

void read_bounds(const Config& c, Benchmark& b) {
  if (!c.has("bounds")) return;
  for (const Config& one : c.objects("bounds")) {
    Bound bound;
    bound.quantity = quantity_named(one.text("quantity"), one, "quantity");
    bound.measure = one.choice("measure", measure_names());
    bound.at_most = one.number("at_most", {0, 1e9});
    bound.up_to = one.number_or("up_to", bound.up_to);
    bound.why = one.text("why");
    one.finish();
    const std::vector<Quantity> has = b.measured();
    if (std::find(has.begin(), has.end(), bound.quantity) == has.end())
      one.fail("quantity", std::string(name_of(bound.quantity)) + " is not measured by this benchmark");
    b.bound.push_back(bound);
  }
}

void read_published(const Config& c, Benchmark& b) {
  if (!c.has("others")) return;
  if (b.led.size() > 1) c.fail("others", "are interpolated along one led quantity, and this benchmark leads two");
  for (const Config& one : c.objects("others")) {
    PublishedPrediction p{one.text("name"), one.text("source"), read_points(one.path("points"), b.led)};
    one.finish();
    std::sort(p.point.begin(), p.point.end(),
              [&](const auto& x, const auto& y) { return x.led.at(b.led.front()) < y.led.at(b.led.front()); });
    b.published.push_back(std::move(p));
  }
}

/// A wheel without carriage rolls where it likes: what it pulls is what slope and load say.
void check_measured(const Config& c, const Benchmark& b) {
  const std::vector<Quantity> has = b.measured();
  const auto measures = [&](Quantity q) { return std::find(has.begin(), has.end(), q) != has.end(); };
  if (b.leads(Quantity::slope) && (measures(Quantity::pull) || measures(Quantity::traction_slope) ||
                                   measures(Quantity::side_force) || measures(Quantity::slip_angle)))
    c.fail("points", "on a given slope slip, sinkage and torque are measured; a pull needs a wheel led at a slip");
  if (b.leads(Quantity::slip) && (measures(Quantity::slope) || measures(Quantity::slip_angle)))
    c.fail("points", "slope and slip_angle are led, not measured; name them under \"led\" or leave them out");
  if (measures(Quantity::side_force) && !b.leads(Quantity::slip_angle))
    c.fail("points", "a side force needs a slip_angle; add its column and name it under \"led\"");
  if (has.empty()) c.fail("points", "nothing is measured; give a column such as pull_N or sinkage_m");
}

Benchmark read_benchmark_file(const fs::path& file) {
  const Config c = Config::read(file);
  Benchmark b;
  b.name = file.stem().string();
  c.choice("schema", {"gonogo/benchmark/1"});
  b.title = c.text("title");
  b.about = c.text("about");
  b.source = c.text("source");
  if (b.source.empty()) c.fail("source", "is empty; say where the numbers come from");
  b.licence = c.text("licence");
  b.assumed = c.text_or("assumed", "");
  read_led(c, b);
  b.point = read_points(c.path("points"), b.led);
  read_judged(c, b);
  read_mover(c, b);
  b.wheel_friction = read_assumed(c.object("wheel_friction"), {0, 2});
  read_soil_state(c.object("soil"), b);
  b.rim_turning = c.number_or("rim_rad_per_s", 0, {1e-4, 1e3});
  b.way = c.number_or("way_m", 0, {1e-3, 1e3});
  if (b.way > 0 && !b.leads(Quantity::slip)) c.fail("way_m", "is for a carriage that leads the slip of a wheel");
  b.slip_at_lugs = c.choice("slip_at", {"rim", "lugs"}) == "lugs";
  b.sinkage_from_lugs = c.choice("sinkage_from", {"rim", "lugs"}) == "lugs";
  check_measured(c, b);
  read_scatter(c, b);
  read_bounds(c, b);
  read_published(c, b);
  c.finish();
  return b;
}

}  // namespace

std::vector<std::string> benchmark_names() {
  const auto places = shipped_folders(kKind);
  if (places.empty()) throw InputError("configs/benchmarks: not found; run from the source tree or set GONOGO_SHARE");
  return shipped_names(places.front());
}

Benchmark read_benchmark(const std::string& name) {
  return read_benchmark_file(shipped_file(kKind, "benchmark", name));
}

namespace {

struct Column {
  Quantity quantity;
  const char *name, *column, *unit;
};
constexpr std::array<Column, 9> kColumns{{{Quantity::slip, "slip", "slip", ""},
                                          {Quantity::slope, "slope", "slope_deg", "deg"},
                                          {Quantity::slip_angle, "slip_angle", "slip_angle_deg", "deg"},
                                          {Quantity::load, "load", "load_N", "N"},
                                          {Quantity::pull, "pull", "pull_N", "N"},
                                          {Quantity::traction_slope, "traction_slope", "traction_slope_deg", "deg"},
                                          {Quantity::side_force, "side_force", "side_force_N", "N"},
                                          {Quantity::torque, "torque", "torque_N_m", "N m"},
                                          {Quantity::sinkage, "sinkage", "sinkage_m", "m"}}};

const Column& entry(Quantity q) { return kColumns[std::size_t(q)]; }

using Row = std::map<Quantity, double>;

Quantity quantity_of_column(const std::filesystem::path& file, const std::string& column) {
  std::vector<std::string> known;
  for (const Column& c : kColumns) {
    if (column == c.column) return c.quantity;
    if (column == c.name) refuse_csv_line(file, 1, "column \"" + column + "\" has no unit; write " + c.column);
    known.emplace_back(c.column);
  }
  refuse_csv_line(file, 1, "column \"" + column + "\" is not known; columns are " + join_words(known));
}

std::vector<Row> rows_of(const std::filesystem::path& file) {
  std::vector<CsvLine> lines = read_csv_lines(file, "points; write a header and a row for each");
  std::vector<Quantity> header;
  for (const std::string& column : lines.front().cell) header.push_back(quantity_of_column(file, column));
  lines.erase(lines.begin());
  std::vector<Row> rows;
  for (const CsvLine& line : lines) {
    const std::vector<std::string>& cells = line.cell;
    if (cells.size() != header.size())
      refuse_csv_line(file, line.number,
                      "has " + std::to_string(cells.size()) + " columns, the header " + std::to_string(header.size()));
    Row& row = rows.emplace_back();
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (!row.emplace(header[i], csv_number(file, line.number, cells[i])).second)
        refuse_csv_line(file, 1, std::string("column \"") + column_of(header[i]) + "\" stands there twice");
  }
  if (rows.empty()) throw InputError(file.string() + ": holds no points; write a header and a row for each");
  return rows;
}

BenchmarkPoint point_of(const std::vector<Row>& repeats, const std::vector<Quantity>& led) {
  BenchmarkPoint p;
  for (const auto& [quantity, first] : repeats.front()) {
    if (std::find(led.begin(), led.end(), quantity) != led.end()) {
      p.led[quantity] = first;
      continue;
    }
    Measured m{0, first, first, int(repeats.size())};
    for (const Row& r : repeats) {
      const double x = r.at(quantity);
      m.mean += x / double(repeats.size());
      m.low = std::min(m.low, x);
      m.high = std::max(m.high, x);
    }
    if (quantity == Quantity::load)
      p.led[quantity] = m.mean;
    else
      p.measured[quantity] = m;
  }
  return p;
}

}  // namespace

const char* name_of(Quantity q) { return entry(q).name; }
const char* column_of(Quantity q) { return entry(q).column; }
const char* unit_of(Quantity q) { return entry(q).unit; }

Quantity quantity_named(const std::string& name, const Config& where, const std::string& key) {
  std::vector<std::string> known;
  for (const Column& c : kColumns) {
    if (name == c.name) return c.quantity;
    known.emplace_back(c.name);
  }
  where.fail(key, "\"" + name + "\" is no quantity; there are " + join_words(known));
}

std::vector<BenchmarkPoint> read_points(const std::filesystem::path& file, const std::vector<Quantity>& led) {
  const std::vector<Row> rows = rows_of(file);
  for (const Quantity q : led)
    if (!rows.front().count(q))
      throw InputError(file.string() + ": has no column \"" + column_of(q) + "\", which is led");
  const auto together = [&](const Row& a, const Row& b) {
    return std::all_of(led.begin(), led.end(), [&](Quantity q) { return a.at(q) == b.at(q); });
  };
  std::vector<std::vector<Row>> groups;
  for (const Row& row : rows) {
    auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return together(g.front(), row); });
    if (group == groups.end()) group = groups.insert(groups.end(), std::vector<Row>{});
    group->push_back(row);
  }
  std::vector<BenchmarkPoint> points;
  for (const auto& repeats : groups) points.push_back(point_of(repeats, led));
  return points;
}

}  // namespace gonogo::lab
