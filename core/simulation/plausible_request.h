// What is known when standard parameters are sought that give stated base parameters: a YAML file with
//
//   base_parameters:             # names as printed by BaseParameters; those left out are free
//     - {name: ZZ1R, value: 1.28, standard_deviation: 0.026}
//   standard_parameters:         # optional, further knowledge about single parameters, likewise
//     - {name: Ia1, value: 0.5, standard_deviation: 0.2}
//   bodies:                      # a rough body for each link, in its frame
//     - {mass: 5, centre: [0.1, 0, 0.05], radii: [0.1, 0.05, 0.05]}     # [kg], [m], [m]
//   spread: 0.3                  # how far the links may be from these bodies, see PlausibleRequest
//
// A body's radii are the root-mean-square extents of its mass along the axes about the centre of mass (a rod of length
// l: l / sqrt(12) along, a ball of radius r: 0.45 r).

#ifndef IDIM_CORE_SIMULATION_PLAUSIBLE_REQUEST_H_
#define IDIM_CORE_SIMULATION_PLAUSIBLE_REQUEST_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/dynamics/base_parameters.h"

namespace idim {

struct StatedParameter {
  int index = -1;  // base: of BaseParameters::parameters(); standard: of StandardModel::parameters()
  double value = 0.0;
  double standard_deviation = 0.0;  // > 0
};

struct RoughBody {
  double mass = 0.0;                                 // [kg] > 0
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // [m] in the frame of the link
  Eigen::Vector3d radii = Eigen::Vector3d::Zero();   // [m] > 0
};

struct PlausibleRequest {
  std::vector<StatedParameter> base;
  std::vector<StatedParameter> standard;
  std::vector<RoughBody> bodies;  // one a link
  // > 0. Standard deviation of the ten log-Cholesky coordinates (core/robot/log_cholesky.h): the masses' factors are
  // e^(2 spread), centres move by `spread` radii.
  double spread = 0.3;
};

// One message with file, line and key on bad input.
Result<PlausibleRequest> ReadPlausibleRequest(const std::string& yaml_path, const BaseParameters& base);

}  // namespace idim

#endif  // IDIM_CORE_SIMULATION_PLAUSIBLE_REQUEST_H_
