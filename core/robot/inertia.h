// The inertial parameters of a link and their order, fixed here once for the whole library.
//
// The ten inertial parameters are those of Gautier & Briot (2014), II.A: the inertia tensor about the
// ORIGIN of the link frame (not about the centre of mass), the first moments and the mass,
//   XX XY XZ YY YZ ZZ [kg m^2]   MX MY MZ [kg m]   M [kg],
// followed in the 14 standard parameters of a link by Ia (drive inertia), Fv, Fs, off.

#ifndef IDIM_CORE_ROBOT_INERTIA_H_
#define IDIM_CORE_ROBOT_INERTIA_H_

#include <Eigen/Core>
#include <array>

namespace idim {

enum StandardIndex { kXX, kXY, kXZ, kYY, kYZ, kZZ, kMX, kMY, kMZ, kM, kIa, kFv, kFs, kOff };
inline constexpr int kNumInertial = 10;
inline constexpr int kNumStandard = 14;

// "XX", "XY", ..., "M", "Ia", "Fv", "Fs", "off".
extern const std::array<const char*, kNumStandard> kStandardNames;

using InertialVector = Eigen::Matrix<double, kNumInertial, 1>;
using StandardVector = Eigen::Matrix<double, kNumStandard, 1>;

// mass [kg], centre of mass in the link frame [m], inertia tensor about the centre of mass in the axes of
// the link frame [kg m^2].
InertialVector InertialFromCentreOfMass(double mass, const Eigen::Vector3d& centre_of_mass,
                                        const Eigen::Matrix3d& inertia_at_centre_of_mass);

// The 3x3 tensor about the origin of the link frame.
Eigen::Matrix3d InertiaTensor(const InertialVector& inertial);

// The same body expressed in frame A, given in frame B; rotation and translation are the pose of B in A
// (a point p_B is rotation * p_B + translation in A).
InertialVector TransformInertial(const InertialVector& in_b, const Eigen::Matrix3d& rotation,
                                 const Eigen::Vector3d& translation);

// The 4x4 pseudo-inertia [Sigma h; h' M] with Sigma = tr(I)/2 - I; the body is physically consistent iff it is
// positive definite (Wensing, Kim & Slotine, 2018).
Eigen::Matrix4d PseudoInertia(const InertialVector& inertial);

InertialVector InertialFromPseudoInertia(const Eigen::Matrix4d& pseudo_inertia);

}  // namespace idim

#endif  // IDIM_CORE_ROBOT_INERTIA_H_
