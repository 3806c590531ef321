// Sums over the segments of an array by a segmented scan (Sengupta, Harris, Zhang, Owens 2007), with a fixed tree: runs
// of neighbouring slots are scanned by one thread each, and a segment adds up the last of its slots in every run that
// it reaches into. Which numbers are added to which follows from their places alone, so sums have the same bits for any
// number of threads; the library's scans on the GPU let their timing decide that. And sums over long stretches, by a
// few lanes that take turns.
#pragma once
#include "base/view.h"

namespace gonogo::sim {

/// Slots that one thread scans.
inline constexpr Index kScanRun = 32;

/// Threads that share a long sum.
inline constexpr Index kSumLanes = 64;

/// How many runs hold `slots` slots.
GONOGO_HD inline Index scan_runs(Index slots) { return (slots + kScanRun - 1) / kScanRun; }

/// Inclusive scan of run number `run`, in place: afterwards a slot holds the sum of the slots of its segment from the
/// first one in the run up to itself. `segment(slot)` names the segment; those of one segment follow each other.
template <class T, class SegmentOf>
struct ScanRun {
  SegmentOf segment;
  View<T> value;       // [slot]
  const Index* slots;  // how many, in the memory of the execution space

  GONOGO_HD void operator()(Index run) const {
    const Index begin = run * kScanRun, full = begin + kScanRun, end = full < *slots ? full : *slots;
    if (begin >= end) return;
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

/// Sum over the slots of a segment, from `begin` to `end`, once all runs have been scanned.
template <class T>
GONOGO_HD T segment_sum(View<const T> scanned, Index begin, Index end) {
  T sum{};
  while (begin < end) {
    const Index of_run = (begin / kScanRun + 1) * kScanRun, next = of_run < end ? of_run : end;
    sum = sum + scanned[next - 1];
    begin = next;
  }
  return sum;
}

/// Part of the sums over stretches of an array: lane l of a stretch takes every kSumLanes-th value from its l-th on. So
/// a stretch has the same bits wherever in the array it lies.
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

/// The sum over a stretch from those of its lanes.
template <class T>
GONOGO_HD T sum_over_lanes(View<const T> partial, Index stretch) {
  T sum{};
  for (Index lane = 0; lane < kSumLanes; ++lane) sum = sum + partial[stretch * kSumLanes + lane];
  return sum;
}

}  // namespace gonogo::sim
