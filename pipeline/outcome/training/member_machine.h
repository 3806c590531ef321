// The machine of one vehicle of a family, without any trial of its own. The family's machine spreads a few dozen units
// over the numbers of all vehicles, and cannot follow its teacher at each. At one vehicle's numbers soil, slope and
// speed are left, and a machine of the same size follows within a few hundredths.
//
// Its rows are drawn: whether they pass from the teacher, and the reason, given that, from the family's machine.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/units.h"
#include "learning/model/model.h"
#include "pipeline/outcome/answer/predictor.h"
#include "pipeline/outcome/training/teacher.h"

namespace gonogo::outcome {

/// A vehicle, as its family is asked about it.
struct FamilyQuestion {
  std::string vehicle;
  double gravity = kGravity;         // where it drives [m/s^2]
  std::vector<double> lower, upper;  // box of its own variables [variable count]; its numbers are fixed
  /// Points of the vehicle as the family's [point count x variables].
  std::function<std::vector<double>(const std::vector<double>& points)> in_family;
};

/// P(go) by the teacher, shifted as the odds of the family's model are (vehicle_odds.h). points: the vehicle's.
std::vector<double> member_forecast(const learning::Model& family, const Teacher& teacher,
                                    const FamilyQuestion& question, const std::vector<double>& points);

/// What a machine is for.
enum class MachineUse {
  answers,  // P(outcome | variables) alone, as maps ask it: trained without the joint likelihood, in half the time
  samples   // rows of variables and outcomes, too
};

/// Takes some seconds. The same inputs give the same bits, for any number of threads.
learning::Model member_machine(const Predictor& family, const Teacher& teacher, const FamilyQuestion& question,
                               MachineUse use);

}  // namespace gonogo::outcome
