// Search for the logs of a kernel that maximise the evidence times a normal prior.
#pragma once
#include <cstddef>
#include <functional>
#include <vector>

namespace gonogo::learning {

/// Log of the evidence of a kernel's logs and its gradient with respect to them.
struct LaplaceEvidence {
  double value = 0;
  std::vector<double> gradient;
};

/// Evidence and its gradient at the logs of a kernel.
using EvidenceOf = std::function<LaplaceEvidence(const std::vector<double>& logs)>;

/// The BFGS method (Nocedal & Wright, "Numerical Optimization", 2006, algorithm 6.1 with formula 6.20) with a line
/// search by bisection. Stages on more and more rows each begin where the one before ended, with what that found of the
/// curvature.
class KernelSearch {
 public:
  /// The prior has its mean at `centre` and this standard deviation for every log.
  KernelSearch(std::vector<double> centre, double width);

  const std::vector<double>& logs() const { return logs_; }
  /// Of the last stage; 0 before.
  std::size_t rows() const { return rows_; }

  /// Ends after `steps`, or where a step should gain less than 0.002 nat after one that gained little. rows: of the
  /// evidence, which curves it.
  void run(const EvidenceOf& evidence_of, std::size_t rows, std::size_t steps);

 private:
  struct At {
    double value = 0;  // to be minimised
    std::vector<double> gradient;
  };

  At at(const std::vector<double>& logs, const EvidenceOf& evidence_of) const;
  void begin(const At& here, std::size_t rows);
  std::vector<double> direction(const std::vector<double>& gradient) const;
  bool advance(At& here, const std::vector<double>& towards, double slope, const EvidenceOf& evidence_of);
  void take_curvature(const std::vector<double>& logs, const std::vector<double>& before,
                      const std::vector<double>& after);

  std::vector<double> centre_;
  double width_;
  std::vector<double> logs_, inverse_;  // [log]; of the curvature [log x log]
  std::size_t rows_ = 0;                // of the last stage
  bool scaled_ = false;
};

}  // namespace gonogo::learning
