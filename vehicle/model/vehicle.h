// A vehicle as its file describes it (configs/vehicles/*.json, docs/vehicles.md): masses, geometry, suspension, wheels
// or tracks, driveline, brakes, driver. Frame: x forward, y left, z up; the file chooses the origin. Everything is
// given in the design position. Suspensions and tracks are given for the left side; the right side is its mirror image.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "base/math/vec.h"

namespace gonogo::vehicle {

/// Piecewise linear; constant beyond the ends.
struct Curve {
  std::vector<double> at, value;  // `at` ascends
  bool empty() const { return at.empty(); }
  double operator()(double x) const;
};

/// A rigid body. `moments` (xx, yy, zz) and `products` (xy, xz, yz) are the entries of its inertia matrix about the
/// centre of mass, in the vehicle's axes [kg m^2].
struct Part {
  std::string name;
  double mass = 0;  // [kg]
  Vec3d centre{};   // [m]
  Vec3d moments{}, products{};
};

/// Spring between two points: force [N], positive apart, over their distance [m].
struct Spring {
  Curve force;                       // never rises with the length
  double shortest = 0, longest = 0;  // range between the stops [m]; 0: no stops
  Curve stop;                        // force over the compression of a stop [m]
  /// Force at a length, with the stops [N].
  double push(double length) const;
};

/// Damper between two points: force [N], positive apart, over the speed at which they separate [m/s].
struct Damper {
  Curve force;                       // falls with the speed
  double shortest = 0, longest = 0;  // outside this range the hydraulic bump acts instead [m]; 0: none
  Curve bump;
};

/// Spring about the axis of an arm. Positive torque turns the wheel down.
struct TorsionSpring {
  double stiffness = 0;  // [N m/rad]
  double damping = 0;    // [N m s/rad]
  double preload = 0;    // in the design position [N m]
};

/// A linear spring and damper [N/m, N s/m].
struct LinearSpring {
  double stiffness = 0, damping = 0;
};

enum class SuspensionType { double_wishbone, trailing_arm, rigid, guided };

/// Suspension of a left wheel. Points are relative to its mounting point [m].
///   double_wishbone  Upper and lower arm turn about their chassis points (upper_front - upper_rear, ...) and hold the
///                    upright at ball joints. The tie rod holds its steering.
///   trailing_arm     An arm turns about the y axis through `pivot`.
///   rigid            The wheel turns in the chassis.
///   guided           Of a quarter vehicle: the wheel's hub slides along z under the sprung mass on `upright_spring`.
struct Suspension {
  std::string name;
  SuspensionType type = SuspensionType::rigid;
  std::map<std::string, Vec3d> point;
  std::map<std::string, Part> part;  // centres are relative to the mounting point too
  double tie_rod_mass = 0;           // shared by its two ends [kg]
  Spring spring;
  Damper damper;
  TorsionSpring torsion;
  LinearSpring upright_spring;  // unloaded in the design position
};

/// All that turns with a wheel, and its tread.
struct Wheel {
  std::string name;
  Part part;                                 // spindle, rim and tyre together, about the wheel's centre
  double radius = 0, width = 0;              // of the tread, without lugs [m]
  int lug_count = 0;                         // lugs or grousers
  double lug_height = 0, lug_thickness = 0;  // [m]
  double friction = 0;                       // coefficient of the tyre on hard ground
  LinearSpring compliant;                    // of the tyre under its load; stiffness 0: rigid
  // Nominal size of the tyre, as in mobility indices; 0: not given [m].
  double size_diameter = 0, size_section_width = 0, size_section_height = 0, size_deflection = 0;
};

enum class Differential { open, limited_slip, locked };

struct Axle {
  std::string name, suspension, wheel;
  Vec3d position{};     // mounting point of the suspension [m]
  bool single = false;  // one wheel in the middle, no right side
  bool driven = false, steered = false;
  double brake_torque = 0;  // per wheel [N m]
  Differential differential = Differential::open;
  double torque_bias = 1;  // limited slip: largest ratio of the two torques
};

/// Data of a track for simulation shoe by shoe.
struct Belt {
  Vec3d shoe_inertia;            // along, across, and at right angles to the plate [kg m^2]
  double pin_radius = 0;         // of the bosses around the pins, which the sprocket's teeth push [m]
  double disc_distance = 0;      // between the middles of the sprocket's two toothed discs [m]
  double wheel_gap = 0;          // between the two discs of road wheels and idlers, where the guides run [m]
  double idler_width = 0;        // over both discs [m]
  Vec3d guide;                   // length, width, height over the pad of the horn on each shoe [m]
  double grouser_thickness = 0;  // along the belt [m]
  double carrier_mass = 0;       // slides with the idler; part of the chassis's mass [kg]
  Vec3d carrier_inertia;         // [kg m^2]
  double tensioner_force = 0;    // at the length at which the belt closes [N]
  double tensioner_stiffness = 0, tensioner_damping = 0;  // [N/m, N s/m]
};

/// Track of the left side; x and z relative to the vehicle's origin.
struct Track {
  double offset = 0;  // y of the track's middle plane [m]
  Part sprocket, idler;
  double sprocket_radius = 0;                      // of the pins [m]
  double idler_radius = 0;                         // [m]
  Vec3d idler_travel;                              // end point of the idler's travel by the tensioner [m]
  std::string suspension, suspension_with_damper;  // of the road wheels without and with damper
  std::string wheel;
  std::vector<double> road_wheel_x, right_road_wheel_x;  // [m]
  double road_wheel_z = 0;
  std::vector<int> damped;  // which road wheels have a damper
  double shoe_mass = 0, shoe_pitch = 0, shoe_width = 0, shoe_height = 0, pad_above_pin = 0, pad_below_pin = 0;
  double grouser_height = 0;
  int left_shoes = 0, right_shoes = 0;
  double brake_torque = 0;  // per sprocket [N m]
  std::optional<Belt> belt;
};

struct Driveline {
  bool wheel_motors = false;
  Curve engine;               // full-throttle torque [N m] over engine speed [rad/s]; of a wheel motor over wheel speed
  double cut_speed = 0;       // engine's limit [rad/s]
  Curve converter;            // torque ratio over speed ratio; empty: none
  Curve converter_capacity;   // input torque over the engine's speed squared [N m s^2] over speed ratio; empty: unknown
  double clutch_torque = 0;   // of a dry clutch [N m]; 0: none
  double engaged_speed = 0;   // engine speed at which the clutch is closed; open at the idle speed [rad/s]
  double engine_inertia = 0;  // [kg m^2]
  double idle_speed = 0;      // [rad/s]
  double up_speed = 0, down_speed = 0;  // engine speeds at which it shifts [rad/s]; 0: never
  double shift_time = 0;                // min time between two shifts [s]
  std::vector<double> gears;            // output over input speed
  double reverse = 0, final_drive = 1;
  double efficiency = 1;
  Differential centre = Differential::open;
  double front_share = 0.5;  // of an open centre differential: torque to the first driven axle
  double centre_bias = 1;
};

struct Driver {
  double throttle_start = 0, throttle_ramp = 0;  // [s]
  double speed = 0;                              // commanded [m/s]; 0: full throttle
  double full_throttle_error = 2;                // shortfall of speed that takes full throttle at once [m/s]
  double integral_time = 5;                      // in which a lasting shortfall takes as much throttle again [s]
  double look_ahead = 0, steering_gain = 0;      // straight-line steering [m], [rad/m]
};

/// single_wheel: a test rig whose carriage holds the wheel upright.
/// quarter: one station of a vehicle with its share of the mass; hub and sprung mass. The rest of the vehicle, which is
/// not simulated, holds roll and yaw: the whole quarter moves along and across the ground, and along the ground's
/// normal hub and sprung mass move separately.
enum class VehicleKind { wheeled, tracked, single_wheel, quarter };

struct Vehicle {
  std::string name, about;
  VehicleKind kind = VehicleKind::wheeled;
  std::vector<std::string> sources, unsourced;
  Part chassis;                   // of a quarter: the sprung mass
  std::vector<Part> fixed_parts;  // fixed to the chassis
  double length = 0, width = 0;   // [m]
  double clearance = 0;           // belly over the ground in the design position [m]
  double power = 0;               // of the engine [W]
  bool automatic = true;          // transmission
  int payload_shares = 1;         // of a quarter: wheels of the vehicle, which carry its payload together
  double max_steering_angle = 0;  // [rad]
  std::vector<Suspension> suspension;
  std::vector<Wheel> wheel;
  std::vector<Axle> axle;
  std::optional<Track> track;
  Driveline driveline;
  Driver driver;
};

/// Reads and checks the file, or its text, of a vehicle that stands by itself or of a single-wheel rig. This and the
/// functions below throw InputError for anything missing or out of range: file, place, value, what to do.
Vehicle read_vehicle(const std::filesystem::path& path);
Vehicle read_vehicle(const Config& c);
/// The same for a quarter vehicle; see configs/vehicles/hmmwv_quarter.json.
Vehicle read_quarter_vehicle(const std::filesystem::path& path);
Vehicle read_quarter_vehicle(const Config& c);
/// A quarter vehicle from its parts: the wheel's `part` holds the mass of the hub and the moment about the axle;
/// length, clearance and shares of the payload are left to the caller. `max_torque`: at the wheel [N m].
Vehicle quarter_vehicle(const std::string& name, Wheel wheel, const LinearSpring& spring, double sprung_mass,
                        double max_torque);
/// A vehicle of whatever kind its file names.
Vehicle read_any_vehicle(const std::filesystem::path& path);
Vehicle read_any_vehicle(const Config& c);

inline bool is_quarter(const Vehicle& v) { return v.kind == VehicleKind::quarter; }

const Suspension& find_suspension(const Vehicle& v, const std::string& name);
const Wheel& find_wheel(const Vehicle& v, const std::string& name);

}  // namespace gonogo::vehicle
