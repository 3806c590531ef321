// Elastic bodies in compliant contact (sim/elastic) against closed forms and published benchmarks.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "pipeline/lab/validate/check_figure.h"

namespace gonogo::lab {

CheckFigure elastic_patch();         // constant strain on distorted meshes of every element
CheckFigure elastic_hertz();         // rigid sphere on a half-space: pressure, radius, approach
CheckFigure elastic_mindlin();       // two equal cylinders, normal then tangential load: stick width
CheckFigure elastic_wave();          // speed of a step along a bar
CheckFigure elastic_energy();        // drift of conservative Newmark, decay of the dissipative one
CheckFigure elastic_critical();      // central differences just below and above the critical step
CheckFigure elastic_newton();        // residuals of a contact step
CheckFigure elastic_epsilon();       // error of regularised friction over its threshold
CheckFigure elastic_block();         // a block slides to rest
CheckFigure elastic_plate();         // benchmark: plate pressed along a rigid plane
CheckFigure elastic_roller();        // benchmark: steel roller on an aluminium block
CheckFigure elastic_tyre_load();     // measured car tyre: deflection over load and pressure
CheckFigure elastic_tyre_patch();    // contact length over load
CheckFigure elastic_tyre_rolling();  // rolling resistance over load and pressure
CheckFigure elastic_tyre_grains();   // on a settled bed, beside the compliant tyre and a rigid wheel

/// Names in the order above, without "elastic_".
std::vector<std::string> elastic_figures();
/// Throws InputError for another name.
CheckFigure elastic_figure(const std::string& name);

}  // namespace gonogo::lab
