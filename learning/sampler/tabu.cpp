// Iterated tabu search: a search for rows of low energy, whose rows follow no distribution. A sweep is a move, which
// turns the spin that lowers the energy most or raises it least. That spin then rests for one to two tenures, so that a
// search leaves local minima (Glover, ORSA J. Comput. 1, 190 (1989)). A search that finds nothing better for a while
// starts again from its best row, some of whose spins are turned at little cost (Palubeckis, Informatica 17, 279
// (2006)). Problems differ in the tenure they need by a factor of ten, so every start draws its own. Draws depend on
// (seed, read) alone, so bits do not depend on threads.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel/host_loop.h"
#include "learning/sampler/chains/spins.h"
#include "learning/sampler/sampler.h"

namespace gonogo::learning {
namespace {

constexpr std::uint64_t kMostDraws = std::uint64_t(1) << 40;  // of a read

/// One state, and dE of every flip.
class TabuState {
 public:
  explicit TabuState(const SpinGraph& graph) : graph_(&graph), spin_(graph.size()), rise_(graph.size()) {}

  void set(std::span<const std::int8_t> spins) {
    std::copy(spins.begin(), spins.end(), spin_.begin());
    energy_ = 0;
    for (std::uint32_t i = 0; i < spin_.size(); ++i) {
      double field = 0;
      for (std::uint32_t k = graph_->first[i]; k < graph_->first[i + 1]; ++k)
        field += graph_->J[k] * spin_[graph_->neighbour[k]];
      rise_[i] = -2 * spin_[i] * (graph_->h[i] + field);
      energy_ += spin_[i] * (graph_->h[i] + field / 2);
    }
  }
  void flip(std::uint32_t i) {
    energy_ += rise_[i];
    rise_[i] = -rise_[i];
    spin_[i] = std::int8_t(-spin_[i]);
    for (std::uint32_t k = graph_->first[i]; k < graph_->first[i + 1]; ++k) {
      const std::uint32_t j = graph_->neighbour[k];
      rise_[j] -= 4 * graph_->J[k] * spin_[i] * spin_[j];
    }
  }
  double energy() const { return energy_; }  // without the problem's offset
  std::span<const double> rise() const { return rise_; }
  std::span<const std::int8_t> spins() const { return spin_; }

 private:
  const SpinGraph* graph_;
  std::vector<std::int8_t> spin_;
  std::vector<double> rise_;
  double energy_ = 0;
};

/// What the number of spins sets, unless it is given.
struct TabuPlan {
  double least_tenure = 0, most_tenure = 0;
  std::size_t patience = 0;                       // moves without a better row after which a search starts again
  std::size_t least_turned = 0, most_turned = 0;  // spins turned at a new start
};

TabuPlan plan_for(std::size_t spins, const SamplerSettings& settings) {
  const auto tenure = double(setting<std::int64_t>(settings, "tenure"));
  const auto patience = std::size_t(setting<std::int64_t>(settings, "patience"));
  TabuPlan plan;
  plan.least_tenure = tenure > 0 ? tenure : std::min(4.0, double(spins) / 2);
  plan.most_tenure = tenure > 0 ? tenure : std::max(plan.least_tenure, double(spins) / 4);
  plan.patience = patience > 0 ? patience : 2 * spins;
  plan.least_turned = std::min<std::size_t>(10, spins / 2 + 1);
  plan.most_turned = std::max(plan.least_turned, spins / 8);
  return plan;
}

/// A read: searches one after another, each with its best row, and the best of all.
class TabuSearch {
 public:
  TabuSearch(const SpinGraph& graph, const TabuPlan& plan, std::uint64_t seed, std::uint64_t read)
      : plan_(plan), random_(seed, read, kMostDraws), state_(graph), free_from_(graph.size()), best_(graph.size()) {
    random_.begin(0);
    for (std::int8_t& spin : best_) spin = draw() < 0.5 ? 1 : -1;
    state_.set(best_);
    begin();
    found_ = best_;
    found_energy_ = best_energy_;
  }

  void move() {
    if (idle_ == plan_.patience) start_again();
    const std::uint32_t i = lowest_rise();
    state_.flip(i);
    ++moves_;
    ++idle_;
    free_from_[i] = double(moves_) + std::floor(tenure_ * (1 + draw()));
    if (is_best(state_.energy())) keep();
  }
  std::span<const std::int8_t> best() const { return found_energy_ < best_energy_ ? found_ : best_; }

 private:
  double draw() { return random_(std::size_t(draws_++)); }
  bool is_best(double energy) const { return energy < best_energy_ - 1e-12 * std::abs(best_energy_); }

  void keep() {
    best_energy_ = state_.energy();
    best_.assign(state_.spins().begin(), state_.spins().end());
    idle_ = 0;
  }

  /// A search from the present state.
  void begin() {
    std::fill(free_from_.begin(), free_from_.end(), 0);
    moves_ = 0;
    tenure_ = plan_.least_tenure * std::pow(plan_.most_tenure / plan_.least_tenure, draw());
    keep();
  }

  /// The spin of least rise that does not rest. A spin that rests may turn if that gives the best row of this search,
  /// or if all rest. Of equal spins the first from a random one on.
  std::uint32_t lowest_rise() {
    const std::span<const double> rise = state_.rise();
    const auto now = double(moves_);
    double least = INFINITY, least_free = INFINITY;
    for (std::size_t i = 0; i < rise.size(); ++i) {
      const double of_free = free_from_[i] <= now ? rise[i] : INFINITY;
      least = rise[i] < least ? rise[i] : least;
      least_free = of_free < least_free ? of_free : least_free;
    }
    const bool any = is_best(state_.energy() + least) || least_free == INFINITY;
    const double wanted = any ? least : least_free, free_at = any ? INFINITY : now;
    auto i = std::uint32_t(draw() * double(rise.size()));
    for (std::size_t passed = 0; passed < rise.size() && (rise[i] != wanted || free_from_[i] > free_at); ++passed)
      i = i + 1 < rise.size() ? i + 1 : 0;
    return i;
  }

  /// From the best row of this search, with some spins turned: each time one of the five of least rise.
  void start_again() {
    constexpr std::size_t kCandidates = 5;
    if (best_energy_ < found_energy_) {
      found_ = best_;
      found_energy_ = best_energy_;
    }
    state_.set(best_);
    std::vector<std::uint32_t> rest(best_.size());
    std::iota(rest.begin(), rest.end(), 0);
    const auto more = std::size_t(draw() * double(plan_.most_turned - plan_.least_turned + 1));
    for (std::size_t turned = 0; turned < plan_.least_turned + more; ++turned) {
      const auto count = std::ptrdiff_t(std::min(kCandidates, rest.size()));
      std::partial_sort(rest.begin(), rest.begin() + count, rest.end(),
                        [&](std::uint32_t a, std::uint32_t b) { return state_.rise()[a] < state_.rise()[b]; });
      const auto chosen = rest.begin() + std::ptrdiff_t(draw() * double(count));
      state_.flip(*chosen);
      rest.erase(chosen);
    }
    begin();
  }

  TabuPlan plan_;
  ChainRandom random_;
  TabuState state_;
  std::vector<double> free_from_;          // moves_ from which a spin may turn
  std::vector<std::int8_t> best_, found_;  // of this search; of those before it
  double tenure_ = 0, best_energy_ = 0, found_energy_ = 0;
  std::uint64_t moves_ = 0, idle_ = 0, draws_ = 0;  // idle_: moves without a better row
};

SampleSet search(const Problem& problem, const SampleRequest& request, const SamplerSettings& settings) {
  const SpinGraph graph(to_ising(problem));
  SampleSet rows = empty_rows(problem, request.reads);
  if (graph.size() == 0) return rows;
  const TabuPlan plan = plan_for(graph.size(), settings);
  rows.info[kSearchOf] = "tabu";
  for_each_on_host(request.reads, 1, [&](std::size_t read) {
    TabuSearch search(graph, plan, request.seed, read);
    for (std::size_t sweep = 0; sweep < request.sweeps; ++sweep) search.move();
    set_row(rows, read, problem, search.best());
  });
  return rows;
}

}  // namespace

extern const SamplerKind kTabu = {
    .name = "tabu",
    .title = "Tabu",
    .about = "Iterated tabu search for rows of low energy, which follow no distribution; a sweep is a move.",
    .parameters = {{"tenure", "--tenure", "moves for which a turned spin rests at least; 0: drawn from 4 to spins / 4",
                    std::int64_t(0), 0.0},
                   {"patience", "--patience", "moves without a better row before a new start; 0: 2 spins",
                    std::int64_t(0), 0.0}},
    .follows_energies = false,
    .sample = search};

}  // namespace gonogo::learning
