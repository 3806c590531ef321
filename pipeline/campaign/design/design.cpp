#include "pipeline/campaign/design/design.h"

#include <algorithm>
#include <numeric>

#include "base/random.h"
#include "pipeline/campaign/design/sobol.h"

namespace gonogo::campaign {
namespace {

constexpr std::uint64_t kBedStream = 0x6265640000000000;        // bed seeds, by index of the trial
constexpr std::uint64_t kReplicateStream = 0x7265706c00000000;  // which point of a block is repeated
constexpr std::uint64_t kCubeStream = 0x6c68730000000000;       // cells and places in them of Latin hypercubes

/// Position of a value in a random permutation of 0 .. size - 1 that belongs to `key`: rank of its random number.
std::vector<std::uint64_t> permutation(std::uint64_t seed, std::uint64_t stream, std::uint64_t first,
                                       std::uint64_t size) {
  std::vector<std::uint64_t> order(size);
  std::iota(order.begin(), order.end(), std::uint64_t(0));
  std::sort(order.begin(), order.end(), [&](std::uint64_t a, std::uint64_t b) {
    const std::uint64_t x = random_bits(seed, stream, first + a), y = random_bits(seed, stream, first + b);
    return x != y ? x < y : a < b;
  });
  return order;
}

/// Coordinates in (0, 1) of the points of one stratum, one after the other.
class UnitPoints {
 public:
  UnitPoints(const DesignSpec& spec, std::uint64_t stratum) : spec_(spec), seed_(spec.seed + (stratum << 32)) {}

  std::vector<double> next() {
    const std::uint64_t number = number_++;
    std::vector<double> unit(spec_.ranges.size());
    if (spec_.method == "latin_hypercube") {
      if (number % spec_.block == 0) begin_cube(number);
      for (std::size_t j = 0; j < unit.size(); ++j)
        unit[j] = (double(cells_[j][number % spec_.block]) + random_unit(seed_, kCubeStream + 2 * j + 1, number)) /
                  double(spec_.block);
    } else {
      for (std::size_t j = 0; j < unit.size(); ++j) unit[j] = scrambled_sobol(std::uint32_t(number), seed_, int(j));
    }
    return unit;
  }

 private:
  void begin_cube(std::uint64_t first) {
    cells_.clear();
    for (std::size_t j = 0; j < spec_.ranges.size(); ++j)
      cells_.push_back(permutation(seed_, kCubeStream + 2 * j, first, spec_.block));
  }

  const DesignSpec& spec_;
  std::uint64_t seed_, number_ = 0;
  std::vector<std::vector<std::uint64_t>> cells_;  // [variable][point of the cube]
};

/// The point of number `number` of all combinations, the last variable running fastest.
DesignPoint combination(const DesignSpec& spec, std::uint64_t number) {
  DesignPoint point;
  point.variables = spec.fixed;
  for (std::size_t j = spec.ranges.size(); j-- > 0;) {
    const SampledVariable& range = spec.ranges[j];
    const std::uint64_t level = number % spec.levels[j];
    number /= spec.levels[j];
    point.variables[range.variable] =
        range.minimum + (range.maximum - range.minimum) * double(level) / double(spec.levels[j] - 1);
  }
  return point;
}

/// Sampled ranges of a stratum: its own, or else the design's.
std::vector<SampledVariable> ranges_of(const DesignSpec& spec, const Stratum& stratum) {
  std::vector<SampledVariable> ranges = spec.ranges;
  for (SampledVariable& range : ranges)
    for (const SampledVariable& own : stratum.ranges)
      if (own.variable == range.variable) range = own;
  return ranges;
}

/// Base points of a design, replicates left out, in order.
class BasePoints {
 public:
  explicit BasePoints(const DesignSpec& spec) : spec_(spec), given_(std::max<std::size_t>(1, spec.strata.size()), 0) {
    for (std::size_t s = 0; s < given_.size(); ++s) units_.emplace_back(spec, s);
  }

  DesignPoint next() {
    const std::uint64_t number = number_++;
    if (!spec_.given.empty()) return spec_.given[number];
    if (spec_.method == "factorial") return combination(spec_, number);
    const std::size_t stratum = next_stratum();
    const std::vector<SampledVariable> ranges =
        spec_.strata.empty() ? spec_.ranges : ranges_of(spec_, spec_.strata[stratum]);
    const std::vector<double> unit = units_[stratum].next();
    DesignPoint point;
    point.variables = spec_.fixed;
    for (std::size_t j = 0; j < ranges.size(); ++j)
      point.variables[ranges[j].variable] = ranges[j].minimum + (ranges[j].maximum - ranges[j].minimum) * unit[j];
    point.proposal_density = stratified_density(spec_, point.variables);
    return point;
  }

 private:
  /// The one that is furthest behind its share: after every point each has its share within one.
  std::size_t next_stratum() {
    if (spec_.strata.empty()) return 0;
    std::size_t best = 0;
    double largest = -1e300;
    for (std::size_t s = 0; s < given_.size(); ++s) {
      const double behind = spec_.strata[s].share * double(number_) - double(given_[s]);
      if (behind > largest) {
        largest = behind;
        best = s;
      }
    }
    ++given_[best];
    return best;
  }

  const DesignSpec& spec_;
  std::uint64_t number_ = 0;
  std::vector<std::uint64_t> given_;  // [strata]
  std::vector<UnitPoints> units_;     // [strata]
};

}  // namespace

double stratified_density(const DesignSpec& spec, const std::vector<double>& variables) {
  if (spec.strata.empty()) return 1;
  double density = 0;
  for (const Stratum& stratum : spec.strata) {
    double part = stratum.share;
    for (const SampledVariable& own : stratum.ranges) {
      const auto whole = std::find_if(spec.ranges.begin(), spec.ranges.end(),
                                      [&](const SampledVariable& r) { return r.variable == own.variable; });
      const double x = variables[own.variable];
      const bool inside = x >= own.minimum && x <= own.maximum;
      part *= inside ? (whole->maximum - whole->minimum) / (own.maximum - own.minimum) : 0;
    }
    density += part;
  }
  return density;
}

std::uint64_t trial_count(const DesignSpec& spec) {
  return spec.points + (spec.replicate_every > 0 ? spec.points / spec.replicate_every : 0);
}

std::vector<DesignPoint> make_design(const DesignSpec& spec) {
  std::vector<DesignPoint> design;
  design.reserve(trial_count(spec));
  const auto add = [&](DesignPoint point) {
    point.index = design.size();
    point.seed = random_bits(spec.seed, kBedStream, point.index);
    design.push_back(std::move(point));
  };
  BasePoints base(spec);
  std::vector<std::uint64_t> block;  // indices of the points since the last replicate
  for (std::uint64_t number = 0; number < spec.points; ++number) {
    block.push_back(design.size());
    add(base.next());
    if (block.size() != spec.replicate_every) continue;
    DesignPoint replicate = design[block[random_bits(spec.seed, kReplicateStream, number) % block.size()]];
    replicate.replicate_of = std::int64_t(replicate.index);
    add(std::move(replicate));
    block.clear();
  }
  return design;
}

}  // namespace gonogo::campaign
