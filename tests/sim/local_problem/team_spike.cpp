// SPIKE by teams on every backend, against sparse LU of Eigen; GPU against CPU.
#include "sim/local_problem/banded/team_spike.h"

#include <Eigen/SparseLU>
#include <barrier>
#include <thread>

#include "sim/local_problem/banded/team_spike_on.h"
#include "tests/sim/local_problem/random_band.h"
#include "tests/support/catch.h"

namespace {

/// Teams of host threads in rows and columns: what blocks are on the GPU.
struct Crews {
  gonogo::Index columns = 1, rows = 1;
};

class CrewMember {
 public:
  static constexpr bool kWholeRows = false;
  CrewMember(Crews crew, gonogo::Index rank, std::barrier<>& barrier) : crew_(crew), rank_(rank), barrier_(&barrier) {}
  gonogo::Index rank() const { return rank_; }
  gonogo::Index size() const { return crew_.columns * crew_.rows; }
  gonogo::Index row() const { return rank_ / crew_.columns; }
  gonogo::Index rows() const { return crew_.rows; }
  gonogo::Index column() const { return rank_ % crew_.columns; }
  gonogo::Index columns() const { return crew_.columns; }
  void sync() const { barrier_->arrive_and_wait(); }

 private:
  Crews crew_;
  gonogo::Index rank_;
  std::barrier<>* barrier_;
};

template <class Body>
void for_each_team(Crews crew, gonogo::Index count, const gonogo::TeamShape& shape, const Body& body) {
  std::barrier barrier(crew.columns * crew.rows);
  std::vector<double> room(shape.room / sizeof(double) + 1);
  std::vector<std::jthread> member;
  for (gonogo::Index rank = 0; rank < crew.columns * crew.rows; ++rank)
    member.emplace_back([&, rank] {
      const CrewMember self(crew, rank, barrier);
      for (gonogo::Index i = 0; i < count; ++i) {
        body(self, i, room.data());
        self.sync();
      }
    });
}

template <class Body>
void for_each_index(Crews, gonogo::Index count, const Body& body) {
  gonogo::for_each_index(gonogo::Cpu{}, count, body);
}

}  // namespace

template <class T>
class gonogo::Buffer<T, Crews> : public gonogo::Buffer<T, gonogo::Cpu> {};

using namespace gonogo::sim;
using Eigen::Index;
using Eigen::VectorXd;

namespace {

using MakeSpike = std::unique_ptr<TeamSpike> (*)(const BandedMatrix<double>&, const TeamSpikeSettings&);

std::unique_ptr<TeamSpike> on_two_threads(const BandedMatrix<double>& a, const TeamSpikeSettings& settings) {
  return team_spike_on_cpu(a, settings, 2);
}

struct Machine {
  const char* name;
  MakeSpike make;
};

/// The CPU and, where one answers, the GPU.
const std::vector<Machine>& machines() {
  static const std::vector<Machine> found = [] {
    std::vector<Machine> list{{"cpu", on_two_threads}};
    try {
      team_spike_on_gpu(random_band(1, 10, 1, 1.2), {});
      list.push_back({"gpu", team_spike_on_gpu});
    } catch (const gonogo::InputError&) {
    }
    return list;
  }();
  return found;
}

std::vector<double> right_side(Index n) {
  std::vector<double> b(std::size_t(n), 0);
  for (Index i = 0; i < n; ++i) b[std::size_t(i)] = std::sin(1.7 * double(i + 1));
  return b;
}

VectorXd vector_of(const std::vector<double>& x) { return Eigen::Map<const VectorXd>(x.data(), Index(x.size())); }

VectorXd direct(const BandedMatrix<double>& a, const std::vector<double>& b) {
  std::vector<Eigen::Triplet<double>> entry;
  for (Index i = 0; i < a.size; ++i)
    for (Index j = std::max<Index>(0, i - a.half); j <= std::min(a.size - 1, i + a.half); ++j)
      entry.emplace_back(i, j, a.at(i, j));
  Eigen::SparseMatrix<double> sparse(a.size, a.size);
  sparse.setFromTriplets(entry.begin(), entry.end());
  return Eigen::SparseLU<Eigen::SparseMatrix<double>>(sparse).solve(vector_of(b));
}

double off(const VectorXd& x, const VectorXd& reference) { return (x - reference).norm() / reference.norm(); }

}  // namespace

TEST_CASE("full SPIKE by teams: sparse LU's solution to 1e-10 for 1 to 64 partitions and the chosen number") {
  for (const auto& [n, half] :
       {std::pair<Index, Index>{400, 3}, {1500, 11}, {701, 0}, {333, 1}, {2600, 20}, {4100, 34}, {7, 5}})
    for (const double dominance : {1.01, 1.3}) {
      const BandedMatrix<double> a = random_band(unsigned(n + half), n, half, dominance);
      const std::vector<double> b = right_side(n), twice(std::size_t(n), 2.5e9);
      const VectorXd reference = direct(a, b), reference_twice = direct(a, twice);
      for (const Machine& machine : machines())
        for (const int partitions : {1, 2, 3, 4, 5, 7, 16, 33, 64, 0}) {
          const auto spike = machine.make(a, {.partitions = partitions});
          INFO(machine.name << " n " << n << " half " << half << " partitions " << partitions << " dominance "
                            << dominance);
          const Index most = std::max<Index>(1, half > 0 ? n / (2 * half) : n);
          if (partitions > 0) CHECK(spike->partitions() == std::min<Index>(partitions, most));
          spike->factorise();
          spike->set_right_side(b);
          spike->solve();
          CHECK(off(vector_of(spike->solution()), reference) < 1e-10);
          spike->set_right_side(twice);  // the same factors
          spike->solve();
          CHECK(off(vector_of(spike->solution()), reference_twice) < 1e-10);
          CHECK(spike->boosted() == 0);
        }
    }
}

TEST_CASE("truncated SPIKE by teams and factors in float reach 1e-10 by refinement in double") {
  const BandedMatrix<double> a = random_band(9, 3000, 8, 1.2);
  const std::vector<double> b = right_side(3000);
  const VectorXd reference = direct(a, b);
  for (const Machine& machine : machines())
    for (const int partitions : {1, 2, 7, 64, 0})
      for (const SpikeKind kind : {SpikeKind::full, SpikeKind::truncated})
        for (const bool is_single : {false, true}) {
          const auto spike = machine.make(a, {partitions, kind, is_single});
          spike->factorise();
          spike->set_right_side(b);
          const TeamSpike::Refined refined = spike->refine(1e-13);
          const VectorXd x = vector_of(spike->solution());
          INFO(machine.name << " partitions " << partitions << " kind " << int(kind) << " single " << is_single
                            << " iterations " << refined.iterations);
          CHECK(off(x, reference) < 1e-10);
          const VectorXd rest = vector_of(b) - product(a, x);
          CHECK(std::abs(refined.residual - rest.norm() / vector_of(b).norm()) < 1e-16 + 0.1 * refined.residual);
          CHECK(refined.iterations >= 1);
          CHECK(refined.iterations <= 12);
          if (!is_single && kind == SpikeKind::truncated && partitions == 64) CHECK(refined.iterations > 1);
          spike->solve();
          CHECK(off(vector_of(spike->solution()), reference) < (is_single ? 1e-4 : 1e-2));
        }
}

TEST_CASE("a pivot of SPIKE by teams that is too small is lifted and counted") {
  BandedMatrix<double> a = random_band(5, 300, 2, 1.5);
  for (Index j = 98; j <= 102; ++j) a.at(100, j) = a.at(j, 100) = 0;
  for (const Machine& machine : machines()) {
    const auto spike = machine.make(a, {.partitions = 4});
    spike->factorise();
    INFO(machine.name);
    CHECK(spike->boosted() == 1);
  }
}

TEST_CASE("the bits of SPIKE by teams depend on the partitions, not on threads or the machine") {
  const BandedMatrix<double> a = random_band(4, 5000, 9, 1.1);
  const std::vector<double> b = right_side(5000);
  for (const SpikeKind kind : {SpikeKind::full, SpikeKind::truncated})
    for (const bool is_single : {false, true}) {
      std::vector<std::unique_ptr<TeamSpike>> spike;
      for (const int threads : {1, 2, 7}) spike.push_back(team_spike_on_cpu(a, {33, kind, is_single}, threads));
      for (std::size_t k = 1; k < machines().size(); ++k)
        for (int again = 0; again < 2; ++again) spike.push_back(machines()[k].make(a, {33, kind, is_single}));
      std::vector<std::vector<double>> x;
      for (const auto& one : spike) {
        one->factorise();
        one->set_right_side(b);
        one->solve();
        x.push_back(one->solution());
      }
      INFO("kind " << int(kind) << " single " << is_single);
      for (const std::vector<double>& other : x) CHECK(other == x[0]);
    }
}

TEST_CASE("the bits of SPIKE by teams do not depend on how many members a team has or how they stand") {
  const BandedMatrix<double> a = random_band(6, 230, 5, 1.1);
  const std::vector<double> b = right_side(230);
  for (const SpikeKind kind : {SpikeKind::full, SpikeKind::truncated}) {
    const TeamSpikeSettings settings{.partitions = 5, .kind = kind};
    const auto alone = team_spike_on_cpu(a, settings);
    alone->factorise();
    alone->set_right_side(b);
    alone->refine(1e-13);
    for (const Crews crew : {Crews{4, 2}, {3, 1}, {1, 5}, {16, 1}}) {
      const auto by_crews = make_team_spike(crew, plan_team_spike(a, settings), a.value, false, [] {});
      by_crews->factorise();
      by_crews->set_right_side(b);
      by_crews->refine(1e-13);
      INFO("kind " << int(kind) << ", " << crew.columns << " x " << crew.rows << " members");
      CHECK(by_crews->solution() == alone->solution());
    }
  }
}
