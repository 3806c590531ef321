// One vehicle in the numbers of a family. Flow of grains under a wheel scales (vehicle/family/numbers.h), so that
// trials at the family's size and gravity answer for members of any size, on any ground: each question is put in the
// family's numbers, and each measure comes back in the member's metres and newtons.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "base/units.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/map/region/rules.h"
#include "vehicle/family/vehicle_numbers.h"

namespace gonogo::map {

/// A vehicle that a family answers for.
struct FamilyMember {
  vehicle::Vehicle vehicle;
  vehicle::Family family;
  double family_gravity = kGravity;  // of the family's trials [m/s^2]
  double gravity = kGravity;         // where the member drives [m/s^2]
  vehicle::VehicleNumbers numbers;   // without payload
  vehicle::MemberScale scale;
  double mass = 0;  // without payload [kg]
};

/// Throws InputError for vehicles on tracks, and for one axle or more than four.
FamilyMember family_member(const vehicle::Family& family, double family_gravity, const vehicle::Vehicle& vehicle,
                           double gravity);

/// A point of the member [variable count] as a point of the family's trials: cohesion, depth of the bed and speed at
/// the family's scale, the payload as part of the load, and uphill the slope that its driveline makes of it
/// (vehicle/family/driveline_share.h). An unknown payload counts as none.
std::vector<double> family_point(const FamilyMember& member, std::span<const double> point);

/// Values of the family's variables that the member has without payload, by their names in the contract. What only
/// helps counts as the most that was sampled where there is more of it: force, power and clearance, and a centre of
/// mass that is lower than sampled as the lowest. No soil returns more than about the weight to a wheel, so that wheels
/// spin long before the largest sampled force. `sampled`: box of the family's model.
Spreads family_values(const FamilyMember& member, const std::vector<Range>& sampled);

/// Points of the member as the family's. values: of family_values().
std::vector<double> family_points(const FamilyMember& member, const Spreads& values, std::span<const double> points);

/// Uphill slopes as the member's driveline lets it feel them [deg].
std::vector<double> felt_slopes(const FamilyMember& member, std::span<const double> slopes);

/// The box of the family's trials at the member's scale, its numbers as they were. Payloads go to a share of the mass,
/// and no further than the family's range. `sampled`: box of the family's model.
std::vector<Range> member_box(const FamilyMember& member, std::vector<Range> sampled, double most_payload);

/// The family's trials as the member would have driven them: points and measures at its scale. Energies and torques
/// keep their share of the weight. Payloads are none.
campaign::Dataset trials_of_member(const campaign::Dataset& family, const FamilyMember& member);

/// A member's own trials as points of the family's, its numbers among their variables. Measures stay the member's.
/// `sampled`: box of the family's model.
campaign::Dataset trials_in_family(const campaign::Dataset& own, const FamilyMember& member,
                                   const std::vector<Range>& sampled);

/// Numbers of the member that lie outside the trials after that, such as "load_number 7.2 (44 % above 0.3 to 5)".
std::vector<std::string> numbers_outside(const FamilyMember& member, const std::vector<Range>& sampled);

}  // namespace gonogo::map
