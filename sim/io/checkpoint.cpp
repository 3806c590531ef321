#include "sim/io/checkpoint.h"

#include <string_view>
#include <type_traits>

#include "base/files/file.h"

namespace gonogo::sim {
namespace {

constexpr const char* kGroup = "snapshot";
constexpr const char* kHistory = "history";  // of penalty contact
constexpr const char* kFormat = "gonogo snapshot";
constexpr std::int64_t kVersion = 8;

/// Concatenated bytes of numbers, and of records that consist of numbers of one size.
class Bytes {
 public:
  template <class T>
  Bytes& operator<<(const T& value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>, "records may have padding; list their fields");
    text_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  template <class T>
  Bytes& operator<<(const Vec3T<T>& v) {
    return *this << v.x << v.y << v.z;
  }
  Bytes& operator<<(const Quat& q) { return *this << q.w << q.x << q.y << q.z; }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

// A record that grows must grow here too.
static_assert(sizeof(PairLaw) == 24 && sizeof(PenaltyLaw) == 28 && sizeof(StepSettings) == 88 && sizeof(Shape) == 68 &&
                  sizeof(Motor) == 40 && sizeof(Attachment) == 44 && sizeof(Joint) == 104 &&
                  sizeof(SpringDamper) == 376 && sizeof(ForceTable) == 260 && sizeof(BodyMass) == 32 &&
                  sizeof(BodyState) == 64 && sizeof(ForceElement) == 80 && sizeof(Controller) == 152 &&
                  sizeof(Monitor) == 112 && sizeof(Driveline) == 632 && sizeof(SceneWorld) == 1192,
              "list the new fields in scene_hash");
static_assert(sizeof(WorldParameters) == 512 && sizeof(Snapshot) == 912,
              "store the new fields, load them and raise kVersion");

void add(Bytes& b, const PairLaw& l) {
  b << l.friction << l.rolling_friction << l.cohesion_pressure << l.spinning_friction << l.stiffness << l.damping;
}
void add(Bytes& b, const PenaltyLaw& l) {
  b << l.stiffness << l.tangential_share << l.modulus << l.shear_modulus << l.restitution << l.work_of_adhesion
    << l.adhesion;
}
void add(Bytes& b, const BodyState& s) { b << s.position << s.orientation << s.velocity << s.angular_velocity; }
void add(Bytes& b, const BodyMass& m) { b << m.inverse_mass << m.inverse_inertia_B; }  // the rest follows in flatten
void add(Bytes& b, const Attachment& a) { b << a.body << a.point_B << a.axis_B << a.side_B; }
void add(Bytes& b, const Joint& j) {
  b << j.type << j.length;
  add(b, j.a);
  add(b, j.b);
}
void add(Bytes& b, const SpringDamper& s) {
  b << s.kind << s.free_length << s.stiffness << s.damping << s.table.count;
  for (int i = 0; i < s.table.count; ++i) b << s.table.stretch[i] << s.table.force[i];
  add(b, s.a);
  add(b, s.b);
}
void add(Bytes& b, const Motor& m) { b << m.kind << m.a << m.b << m.axis_B << m.target << m.max_torque; }
/// Types keep the numbers that they had before ellipsoids came between them: scenes of older checkpoints are known
/// again.
std::int32_t number_of(ShapeType type) {
  if (type == ShapeType::ellipsoid) return 100;
  return std::int32_t(type) - (type > ShapeType::ellipsoid ? 1 : 0);
}
void add(Bytes& b, const Shape& s) {
  b << number_of(s.type) << s.body << s.material << s.group << s.lug_count << s.surface << s.offset_B << s.size
    << s.lug_thickness << s.turn_B;
}
/// As when one list numbered iterations and penalty laws.
std::int32_t number_of(ContactLaw contact, Iteration iteration) {
  return is_penalty(contact) ? 4 + std::int32_t(contact) : std::int32_t(iteration);
}
void add(Bytes& b, const StepSettings& s) {
  b << s.step << s.iterations << s.tolerance << s.envelope << s.recovery_speed << s.recovery_share << s.cohesion_range
    << number_of(s.contact, s.iteration) << s.target << s.substeps << s.sort_every << s.max_slowed;
  if (s.give > 0) b << s.give << s.give_share;  // only then, so that older checkpoints are known again
}

void add(Bytes& b, const TablePoint& p) { b << p.at << p.value; }
void add(Bytes& b, const ForceElement& f) {
  b << f.type << f.body << f.frame << f.point_B << f.force << f.torque << f.start << f.ramp << f.drag << f.wind;
}
void add(Bytes& b, const Monitor& m) {
  b << m.body << m.motor << m.height << m.start << m.stride << m.time_limit << m.earliest << m.distance << m.slid_back
    << m.immobile_window << m.immobile_from << m.immobile_speed << m.up << m.min_up;
}

template <class T>
void add_all(Bytes& b, const std::vector<T>& list) {
  b << std::uint64_t(list.size());
  for (const T& item : list) add(b, item);
}

void add(Bytes& b, const Controller& c) {
  b << c.type << c.motor;
  add_all(b, c.command);
  add_all(b, c.limit);
  b << c.body << c.frame << c.axis << c.proportional << c.integral << c.feed_forward << c.top_speed << c.look_ahead
    << c.max_angle << c.rate << c.pointer_a;
}

void add(Bytes& b, const Driveline& d) {
  b << d.coupling << d.axle_count << d.gear_count << d.brake_count;
  for (const DrivenAxle& a : d.axle) b << a.wheel[0] << a.wheel[1] << a.lock << a.share << a.bias;
  for (const double ratio : d.ratio) b << ratio;
  for (const Brake& brake : d.brake) b << brake.motor << brake.torque;
  b << d.first_gear << d.up_speed << d.down_speed << d.shift_time << d.efficiency << d.wheel_inertia << d.engine_inertia
    << d.idle_speed << d.clutch_torque << d.engaged_speed << d.way_per_radian << d.body << d.axis_B << d.proportional
    << d.integral;
  for (const auto* table : {&d.torque, &d.torque_ratio, &d.capacity, &d.throttle, &d.braking, &d.speed})
    add_all(b, *table);
}

void add(Bytes& b, const std::shared_ptr<const TriangleMesh>& m) {
  b << m->open << std::uint64_t(m->vertex.size()) << std::uint64_t(m->triangle.size());
  for (const Vec3& p : m->vertex) b << p;
  for (const auto& [i, j, k] : m->triangle) b << i << j << k;
}
void add(Bytes& b, const std::shared_ptr<const Heightfield>& f) {
  b << f->nx << f->ny << f->spacing_x << f->spacing_y;
  for (const Real h : f->height) b << h;
}

// The name of a mesh and the limit that the start was checked against do not change a run.
void add(Bytes& b, const SceneWorld& w) {
  b << w.gravity << w.origin << w.size << w.periodic_x << w.periodic_y;
  for (const auto& row : w.law)
    for (const PairLaw& law : row) add(b, law);
  add_all(b, w.body);
  add_all(b, w.mass);
  add_all(b, w.shape);
  add_all(b, w.joint);
  add_all(b, w.spring);
  add_all(b, w.motor);
  add_all(b, w.force);
  add_all(b, w.controller);
  add_all(b, w.driveline);
  add_all(b, w.monitor);
  add_all(b, w.mesh);
  add_all(b, w.heightfield);
}

/// Everything about a world that is not a list of bodies or contacts; gravity and laws may change during a run.
constexpr std::size_t kWorldNumbers = 12 + 6 * kMaxMaterials * kMaxMaterials, kWorldIntegers = 18;

template <class Visit>
void visit_numbers(WorldParameters& p, Visit&& visit) {
  for (Vec3* v : {&p.gravity, &p.bin_size}) {
    visit(v->x);
    visit(v->y);
    visit(v->z);
  }
  for (Vec3d* v : {&p.origin, &p.period}) {
    visit(v->x);
    visit(v->y);
    visit(v->z);
  }
  for (auto& row : p.law)
    for (PairLaw& l : row)
      for (Real* x :
           {&l.friction, &l.rolling_friction, &l.cohesion_pressure, &l.spinning_friction, &l.stiffness, &l.damping})
        visit(*x);
}

template <class Visit>
void visit_integers(Snapshot& s, Visit&& visit) {
  WorldParameters& p = s.world;
  for (Index* i : {&s.steps, &s.flags, &s.slowed, &p.bins[0], &p.bins[1], &p.bins[2], &p.first_bin, &p.first_body,
                   &p.body_count, &p.first_shape, &p.shape_count, &p.first_large, &p.large_count, &p.first_motor,
                   &p.motor_count, &s.fault.flags, &s.fault.step, &s.fault.body})
    visit(*i);
}

/// Numbers of type Number that a record consists of.
template <class Number, class Record>
constexpr std::size_t numbers_in_record() {
  static_assert(sizeof(Record) % sizeof(Number) == 0 && std::is_trivially_copyable_v<Record>);
  return sizeof(Record) / sizeof(Number);  // NOLINT(bugprone-sizeof-expression): some records are one number
}

/// Writes arrays and collects what their hash is taken of.
class Store {
 public:
  explicit Store(Hdf5Writer& out) : out_(out) {}

  /// Rows of records that consist of numbers of type Number.
  template <class Number, class Record>
  void rows(const std::string& name, const std::vector<Record>& records) {
    constexpr std::size_t columns = numbers_in_record<Number, Record>();
    const auto* first = reinterpret_cast<const Number*>(records.data());
    numbers(name, std::vector<Number>(first, first + columns * records.size()), columns);
  }
  template <class Number>
  void numbers(const std::string& name, const std::vector<Number>& values, std::size_t columns) {
    out_.array(std::string(kGroup) + "/" + name, values, gonogo::Shape{values.size() / columns, columns});
    hashes_ += name + content_hash({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Number)});
  }
  std::string hash() const { return content_hash(hashes_); }

 private:
  Hdf5Writer& out_;
  std::string hashes_;
};

/// The mirror image of Store.
class Load {
 public:
  explicit Load(const Hdf5Reader& in) : in_(in) {}

  template <class Number, class Record>
  void rows(const std::string& name, std::vector<Record>& records) {
    constexpr std::size_t columns = numbers_in_record<Number, Record>();
    const std::vector<Number> values = numbers<Number>(name, columns);
    records.resize(values.size() / columns);
    std::copy(values.begin(), values.end(), reinterpret_cast<Number*>(records.data()));
  }
  template <class Number>
  std::vector<Number> numbers(const std::string& name, std::size_t columns) {
    const std::string place = std::string(kGroup) + "/" + name;
    const gonogo::Shape shape = in_.shape(place);
    if (shape.size() != 2 || shape[1] != columns)
      in_.fail(place, "needs " + std::to_string(columns) + " columns; remove the file and start from the beginning");
    auto values = in_.array<Number>(place);
    hashes_ += name + content_hash({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(Number)});
    return values;
  }
  std::string hash() const { return content_hash(hashes_); }

 private:
  const Hdf5Reader& in_;
  std::string hashes_;
};

/// Arrays of a snapshot that Store and Load treat alike.
template <class Io, class Snap>
void exchange_arrays(Io& io, Snap& s) {
  io.template rows<std::int32_t>("place_of_body", s.place_of_body);
  io.template rows<double>("position", s.position);
  io.template rows<float>("orientation", s.orientation);
  io.template rows<float>("velocity", s.velocity);
  io.template rows<std::int32_t>("contact_begin", s.contact_begin);
  io.template rows<std::int32_t>("contact_end", s.contact_end);
  io.template rows<std::uint64_t>("key", s.key);
  io.template rows<float>("impulse", s.impulse);
  io.template rows<float>("motor_impulse", s.motor_impulse);
  io.template rows<double>("controller", s.element.controller);
  io.template rows<double>("driveline", s.element.driveline);
}

/// Records of mixed numbers, byte by byte.
static_assert(sizeof(MonitorSample) == 80 && sizeof(MonitorState) == 144 && sizeof(WorldStop) == 12,
              "files of older programs do not fit any more: raise kVersion");

void store_monitors(Store& store, const Snapshot& s) {
  store.rows<std::int32_t>("stop", std::vector<WorldStop>{s.element.stop});
  store.rows<std::uint8_t>("monitor", s.element.monitor);
  store.rows<std::uint8_t>("monitor_sample", s.element.sample);
}

void load_monitors(Load& load, Snapshot& s) {
  std::vector<WorldStop> stop;
  load.rows<std::int32_t>("stop", stop);
  if (!stop.empty()) s.element.stop = stop.front();
  load.rows<std::uint8_t>("monitor", s.element.monitor);
  load.rows<std::uint8_t>("monitor_sample", s.element.sample);
}

void store_world(Store& store, Snapshot s) {
  std::vector<double> number;
  std::vector<std::int32_t> integer;
  visit_numbers(s.world, [&](auto& x) { number.push_back(double(x)); });
  visit_integers(s, [&](Index& i) { integer.push_back(i); });
  store.numbers("world_numbers", number, kWorldNumbers);
  store.numbers("world_integers", integer, kWorldIntegers);
}

void load_world(Load& load, Snapshot& s) {
  const auto number = load.numbers<double>("world_numbers", kWorldNumbers);
  const auto integer = load.numbers<std::int32_t>("world_integers", kWorldIntegers);
  if (number.size() != kWorldNumbers || integer.size() != kWorldIntegers) return;  // the content's hash will refuse it
  auto next_number = number.begin();
  auto next_integer = integer.begin();
  visit_numbers(s.world, [&](auto& x) { x = std::decay_t<decltype(x)>(*next_number++); });
  visit_integers(s, [&](Index& i) { i = *next_integer++; });
}

constexpr std::size_t kMotorIntegers = 5, kMotorNumbers = 5;

template <class M, class VisitInteger, class VisitNumber>
void visit_motor(M& m, VisitInteger&& integer, VisitNumber&& number) {
  integer(m.kind);
  integer(m.a);
  integer(m.b);
  integer(m.slot_a);
  integer(m.slot_b);
  number(m.axis_B.x);
  number(m.axis_B.y);
  number(m.axis_B.z);
  number(m.target);
  number(m.max_torque);
}

void store_motors(Store& store, const Snapshot& s) {
  std::vector<std::int32_t> integer;
  std::vector<float> number;
  for (const Motor& m : s.motor)
    visit_motor(
        m, [&](auto i) { integer.push_back(std::int32_t(i)); }, [&](Real x) { number.push_back(x); });
  store.numbers("motor_integers", integer, kMotorIntegers);
  store.numbers("motor_numbers", number, kMotorNumbers);
}

void load_motors(Load& load, Snapshot& s) {
  const auto integer = load.numbers<std::int32_t>("motor_integers", kMotorIntegers);
  const auto number = load.numbers<float>("motor_numbers", kMotorNumbers);
  if (integer.size() != number.size()) return;  // the content's hash will refuse it
  s.motor.resize(integer.size() / kMotorIntegers);
  auto next_integer = integer.begin();
  auto next_number = number.begin();
  for (Motor& m : s.motor)
    visit_motor(
        m, [&](auto& i) { i = std::decay_t<decltype(i)>(*next_integer++); }, [&](Real& x) { x = *next_number++; });
}

void check_head(const Hdf5Reader& in, const std::string& scene) {
  const std::string place = kGroup;
  if (!in.has(place) || !in.has_attribute(place, "format") || in.text_attribute(place, "format") != kFormat)
    in.fail(place, "this is no checkpoint; name one that this program wrote or remove the file");
  if (const std::int64_t version = in.integer_attribute(place, "version"); version != kVersion)
    in.fail(place, "is of version " + std::to_string(version) + ", this program reads " + std::to_string(kVersion) +
                       "; remove the file and start from the beginning");
  if (in.text_attribute(place, "scene") != scene)
    in.fail(place,
            "belongs to another scene or other numerics; give the file the run it came from, or remove it and start "
            "from the beginning");
}

}  // namespace

std::string scene_hash(const SceneWorld& world, const StepSettings& settings) {
  Bytes b;
  add(b, settings);
  add(b, world);
  if (is_penalty(settings.contact)) {
    add(b, settings.penalty);
    for (const auto& row : world.penalty)
      for (const PenaltyLaw& law : row) add(b, law);
  }
  return content_hash(b.text());
}

std::string store_snapshot(Hdf5Writer& out, const Snapshot& snapshot, const std::string& scene) {
  out.group(kGroup);
  out.attribute(kGroup, "format", kFormat);
  out.attribute(kGroup, "version", kVersion);
  out.attribute(kGroup, "scene", scene);
  Store store(out);
  exchange_arrays(store, snapshot);
  if (!snapshot.history.empty()) store.rows<float>(kHistory, snapshot.history);
  store_world(store, snapshot);
  store_motors(store, snapshot);
  store_monitors(store, snapshot);
  const std::string content = store.hash();
  out.attribute(kGroup, "content", content);
  return content;
}

Snapshot read_snapshot(const Hdf5Reader& in, const std::string& scene, std::string* content) {
  check_head(in, scene);
  Snapshot s;
  Load load(in);
  exchange_arrays(load, s);
  if (in.has(std::string(kGroup) + "/" + kHistory)) load.rows<float>(kHistory, s.history);
  load_world(load, s);
  load_motors(load, s);
  load_monitors(load, s);
  if (in.text_attribute(kGroup, "content") != load.hash())
    in.fail(kGroup, "its numbers were altered; remove the file and start from the beginning");
  if (content) *content = load.hash();
  return s;
}

void save_checkpoint(const std::filesystem::path& path, const Snapshot& snapshot, const std::string& scene) {
  Hdf5Writer out;
  store_snapshot(out, snapshot, scene);
  out.save(path);
}

Snapshot load_checkpoint(const std::filesystem::path& path, const std::string& scene) {
  return read_snapshot(Hdf5Reader(path), scene);
}

}  // namespace gonogo::sim
