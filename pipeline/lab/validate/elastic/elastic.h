// Elastic bodies in compliant contact (sim/elastic) against closed forms and published benchmarks.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "pipeline/lab/validate/soil_figure.h"

namespace gonogo::lab {

/// Same form as the figures of soils: curves, a table, numbers with bounds.
using ElasticFigure = SoilFigure;

ElasticFigure elastic_patch();         // constant strain on distorted meshes of every element
ElasticFigure elastic_hertz();         // rigid sphere on a half-space: pressure, radius, approach
ElasticFigure elastic_mindlin();       // two equal cylinders, normal then tangential load: stick width
ElasticFigure elastic_wave();          // speed of a step along a bar
ElasticFigure elastic_energy();        // drift of conservative Newmark, decay of the dissipative one
ElasticFigure elastic_critical();      // central differences just below and above the critical step
ElasticFigure elastic_newton();        // residuals of a contact step
ElasticFigure elastic_epsilon();       // error of regularised friction over its threshold
ElasticFigure elastic_block();         // a block slides to rest
ElasticFigure elastic_plate();         // benchmark: plate pressed along a rigid plane
ElasticFigure elastic_roller();        // benchmark: steel roller on an aluminium block
ElasticFigure elastic_tyre_load();     // measured car tyre: deflection over load and pressure
ElasticFigure elastic_tyre_patch();    // contact length over load
ElasticFigure elastic_tyre_rolling();  // rolling resistance over load and pressure
ElasticFigure elastic_tyre_grains();   // on a settled bed, beside the compliant tyre and a rigid wheel

/// Names in the order above, without "elastic_".
std::vector<std::string> elastic_figures();
/// Throws InputError for another name.
ElasticFigure elastic_figure(const std::string& name);

}  // namespace gonogo::lab
