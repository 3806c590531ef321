// A sidewall as a membrane: an arc of constant length L between rim and belt, blown out by the pressure p. With the
// chord c and half the angle t of the arc, L = 2 t r and c = 2 r sin t. Balance of the arc: its tension is p r. Along
// the chord it pulls the belt with
//   f(c) = p r cos t = p c / (2 tan t),    f'(c) = p / 2 (t sin t + cos t) / (sin t - t cos t)
// per length of the belt. f falls below 0 when the arc is more than half a circle. f is minus p times the derivative of
// the area between arc and chord.
#pragma once

namespace gonogo::sim::elastic {

struct Pull {
  double force = 0;      // towards the rim, per length [N/m]
  double stiffness = 0;  // its derivative by the chord [N/m^2]
  double energy = 0;     // -p times the area between arc and chord, per length [J/m]
};

class Membrane {
 public:
  Membrane() = default;
  /// `chord` above 0 and `bulge` above 0, at most half the chord [m], of the unloaded tyre.
  Membrane(double chord, double bulge, double pressure);
  double length() const { return length_; }
  /// Chords beyond those of t in [0.2, 3] are continued with constant stiffness.
  Pull at(double chord) const;

 private:
  double length_ = 0, pressure_ = 0;
};

}  // namespace gonogo::sim::elastic
