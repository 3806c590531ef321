#include "vehicle/feasible/force_fit.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "vehicle/feasible/force_program.h"
#include "vehicle/model/assembly.h"

namespace gonogo::vehicle {
namespace {

constexpr double kLargest = 1e9;          // [N]
constexpr double kLeastDeviation = 1e-3;  // [N]

void read_wheel(const Config& wheel, int contact, std::vector<MeasuredForce>& forces) {
  for (int component = 0; component < 3; ++component) {
    const auto given = wheel.object_if(kForceComponent[component]);
    if (!given) continue;
    forces.push_back({.contact = contact,
                      .component = component,
                      .force = given->number("force_N", {-kLargest, kLargest}),
                      .deviation = given->number("deviation_N", {kLeastDeviation, kLargest})});
    given->finish();
  }
  wheel.finish();
}

using multibody::MatrixX;
using multibody::VectorX;

/// Room of cones and limits, as a share of the mean load, that gives the program an interior.
constexpr double kRoom = 1e-6;

/// Constraints of the forces at a pose, and the data as one more cone.
class DataProgram {
 public:
  DataProgram(const Vehicle& v, const ForceProgram& forces, double best_reserve, const std::vector<MeasuredForce>& data)
      : name_(v.name), forces_(forces), data_(data) {
    const double reserve = std::min(0.0, best_reserve - kRoom);
    constraints_ = forces.constraints({{forces.share(), 1.0}, {forces.reserve(), reserve}});
    least_deviation_ = data[0].deviation;
    for (const MeasuredForce& m : data) least_deviation_ = std::min(least_deviation_, m.deviation);
  }

  /// x with the least |W (D x - data)|, of those in the middle of all such x.
  VectorX nearest() const {
    const Eigen::Index n = constraints_.c.size();
    ConeProgram p = with_data(n + 1);
    p.c(n) = 1;
    p.G(constraints_.G.rows(), n) = -1;
    return solved(p).head(n);
  }

  /// Least and largest value of a column where |W (D x - data)|^2 is at most chi_square.
  std::pair<double, double> range(int column, double chi_square) const {
    ConeProgram p = with_data(constraints_.c.size());
    p.h(constraints_.G.rows()) = std::sqrt(chi_square) * least_deviation_ / forces_.load();
    p.c(column) = 1;
    const double low = solved(p)(column);
    p.c(column) = -1;
    return {low, solved(p)(column)};
  }

  double residual(const VectorX& x, const MeasuredForce& m) const {
    return (x(column(m)) * forces_.load() - m.force) / m.deviation;
  }

  /// Directions that neither equations nor data see, one a column.
  MatrixX unseen() const { return null_space(with_rows_of_data()); }
  /// Number of combinations of the data that the equations leave open.
  int seen_by_data() const { return int(null_space(constraints_.A).cols() - null_space(with_rows_of_data()).cols()); }

 private:
  int column(const MeasuredForce& m) const { return 3 * m.contact + m.component; }

  /// (., W (D x - data)) appended as a cone, in mean loads and the least deviation; its first row is left 0.
  ConeProgram with_data(Eigen::Index columns) const {
    const Eigen::Index rows = constraints_.G.rows(), added = Eigen::Index(data_.size()) + 1;
    ConeProgram p = constraints_;
    p.c = VectorX::Zero(columns);
    p.A = MatrixX::Zero(constraints_.A.rows(), columns);
    p.A.leftCols(constraints_.A.cols()) = constraints_.A;
    p.G = MatrixX::Zero(rows + added, columns);
    p.G.topLeftCorner(rows, constraints_.G.cols()) = constraints_.G;
    p.h = VectorX::Zero(rows + added);
    p.h.head(rows) = constraints_.h;
    for (Eigen::Index i = 1; i < added; ++i) {
      const MeasuredForce& m = data_[std::size_t(i - 1)];
      const double weight = least_deviation_ / m.deviation;
      p.G(rows + i, column(m)) = -weight;
      p.h(rows + i) = -weight * m.force / forces_.load();
    }
    p.cone.push_back(int(added));
    return p;
  }

  MatrixX with_rows_of_data() const {
    MatrixX m(constraints_.A.rows() + Eigen::Index(data_.size()), constraints_.A.cols());
    m.topRows(constraints_.A.rows()) = constraints_.A;
    for (std::size_t i = 0; i < data_.size(); ++i)
      m.row(constraints_.A.rows() + Eigen::Index(i)) = VectorX::Unit(m.cols(), column(data_[i]));
    return m;
  }

  static MatrixX null_space(const MatrixX& m) {
    Eigen::JacobiSVD<MatrixX> svd(m, Eigen::ComputeFullV);
    svd.setThreshold(1e-10);
    return svd.matrixV().rightCols(m.cols() - svd.rank());
  }

  VectorX solved(const ConeProgram& p) const {
    constexpr double kTolerance = 1e-8;  // of the mean load
    const ConeAnswer a = solve(p, kTolerance);
    if (!a.consistent || !a.solved) throw DeviceError(name_ + ": the cone program of the data did not converge");
    return a.x;
  }

  const std::string& name_;
  const ForceProgram& forces_;
  const std::vector<MeasuredForce>& data_;
  ConeProgram constraints_;
  double least_deviation_ = 1;  // [N]
};

void check(const Demand& d, const std::vector<MeasuredForce>& data) {
  if (d.step > 0) throw InputError("measured forces are for a plane; leave them or the step out");
  if (d.edge_distance > 0) throw InputError("measured forces take no distance from the edge; leave one of them out");
  if (data.empty()) throw InputError("no force is measured; give at least one component of one wheel");
}

FittedContact contact_of(const DataProgram& program, const ForceProgram& forces, const VectorX& x,
                         const MatrixX& unseen, int contact, double chi_square) {
  FittedContact c;
  for (int k = 0; k < 3; ++k) {
    const int column = 3 * contact + k;
    FittedForce& f = c.component[std::size_t(k)];
    f.force = x(column) * forces.load();
    const auto [low, high] = program.range(column, chi_square + 1);
    f.low = low * forces.load();
    f.high = high * forces.load();
    f.determined = unseen.cols() == 0 || unseen.row(column).norm() < 1e-8;
  }
  return c;
}

}  // namespace

std::vector<MeasuredForce> read_measured_forces(const std::filesystem::path& path, const Vehicle& v) {
  std::vector<std::string> names;
  for (const Station& s : stations(v)) names.push_back(s.name);
  const Config file = Config::read(path);
  const Config wheels = file.object("wheels");
  file.finish();
  std::vector<MeasuredForce> forces;
  for (const auto& [name, wheel] : wheels.members()) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) wheels.fail(name, v.name + " has no such wheel; it has: " + join_words(names));
    read_wheel(wheel, int(found - names.begin()), forces);
  }
  if (forces.empty()) wheels.fail("", "no force is measured; give at least one component of one wheel");
  return forces;
}

ForceFit fit_forces(const Vehicle& v, const Demand& demand, const std::vector<MeasuredForce>& data,
                    const Limits& limits) {
  check(demand, data);
  const double best_reserve = feasible(v, demand, limits).reserve;
  ForceFit fit;
  fit.admissible = best_reserve >= kLeastReserve;
  if (!fit.admissible) return fit;
  const Pose pose = level_pose(v);
  const ForceProgram forces(v, pose, demand, limits);
  const DataProgram program(v, forces, best_reserve, data);
  const VectorX x = program.nearest();
  for (const MeasuredForce& m : data) fit.chi_square += std::pow(program.residual(x, m), 2);
  fit.degrees = int(data.size()) - program.seen_by_data();
  const auto wheels = stations(v);
  const MatrixX unseen = program.unseen();
  for (int i = 0; i < forces.contacts(); ++i) {
    fit.contact.push_back(contact_of(program, forces, x, unseen, i, fit.chi_square));
    FittedContact& c = fit.contact.back();
    c.wheel = wheels[std::size_t(pose.contact[std::size_t(i)].station)].name;
    if (x(3 * i) > kRoom) c.friction_used = std::hypot(x(3 * i + 1), x(3 * i + 2)) / (demand.friction * x(3 * i));
  }
  for (const MeasuredForce& m : data) {
    FittedForce& f = fit.contact[std::size_t(m.contact)].component[std::size_t(m.component)];
    f.measured = m;
    f.residual = program.residual(x, m);
  }
  for (std::size_t u = 0; u < forces.units().size(); ++u) {
    fit.unit.push_back(forces.units()[u].name);
    fit.torque.push_back(x(forces.torque(int(u))) * forces.load() * forces.radius());
  }
  return fit;
}

}  // namespace gonogo::vehicle
