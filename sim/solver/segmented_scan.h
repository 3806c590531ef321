// Sums over the segments of an array by a segmented scan (Sengupta, Harris, Zhang, Owens 2007) with a fixed tree. One
// thread scans each run of neighbouring slots; a segment then adds its last slot in every run it reaches into. The
// order of additions follows from the slots' places alone, so any number of threads gives the same bits. In the GPU
// library's scans it depends on timing. Also: sums over long stretches by a fixed number of lanes.
#pragma once
#include "base/parallel/buffer.h"

namespace gonogo::sim {

/// Slots that one thread scans.
inline constexpr Index kScanRun = 32;

/// Threads that share a long sum.
inline constexpr Index kSumLanes = 64;

/// How many runs hold `slots` slots.
GONOGO_HD inline Index scan_runs(Index slots) { return (slots + kScanRun - 1) / kScanRun; }

/// Inclusive scan of run number `run`, in place: each slot becomes the sum of its segment's slots from the run's start
/// up to itself. `segment(slot)`: the slot's segment; the slots of a segment are contiguous.
template <class T, class SegmentOf>
struct ScanRun {
  SegmentOf segment;
  View<T> value;       // [slot]
  const Index* slots;  // how many, in the memory of the execution space

  GONOGO_HD void operator()(Index run) const {
    const Index begin = run * kScanRun, full = begin + kScanRun, end = full < *slots ? full : *slots;
    if (begin >= end) return;
    GONOGO_ASSERT(end <= value.size);
    T sum = value[begin];
    Index open = segment(begin);
    for (Index i = begin + 1; i < end; ++i) {
      const Index next = segment(i);
      T own = value[i];
      if (next == open) own = sum + own;
      value[i] = sum = own;
      open = next;
    }
  }
};

/// Sum over the slots of a segment from `begin` to `end` - 1, after all runs have been scanned.
template <class T>
GONOGO_HD T segment_sum(View<const T> scanned, Index begin, Index end) {
  GONOGO_ASSERT(begin >= 0 && begin <= end && end <= scanned.size);
  T sum{};
  while (begin < end) {
    const Index of_run = (begin / kScanRun + 1) * kScanRun, next = of_run < end ? of_run : end;
    sum = sum + scanned[next - 1];
    begin = next;
  }
  return sum;
}

/// Partial sums over stretches of an array: lane l of a stretch adds every kSumLanes-th value from the l-th on. A
/// stretch has the same bits anywhere in the array.
template <class T>
struct SumByLanes {
  View<const Index> first;  // [stretch + 1]
  View<const T> value;
  View<T> partial;  // [stretch * kSumLanes]

  GONOGO_HD void operator()(Index i) const {
    const Index stretch = i / kSumLanes;
    T sum{};
    for (Index k = first[stretch] + i % kSumLanes; k < first[stretch + 1]; k += kSumLanes) sum = sum + value[k];
    partial[i] = sum;
  }
};

/// Sum over a stretch from its lanes' sums.
template <class T>
GONOGO_HD T sum_over_lanes(View<const T> partial, Index stretch) {
  T sum{};
  for (Index lane = 0; lane < kSumLanes; ++lane) sum = sum + partial[stretch * kSumLanes + lane];
  return sum;
}

}  // namespace gonogo::sim
