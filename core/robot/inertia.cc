#include "core/robot/inertia.h"

namespace idim {

const std::array<const char*, kNumStandard> kStandardNames = {"XX", "XY", "XZ", "YY", "YZ", "ZZ", "MX",
                                                              "MY", "MZ", "M",  "Ia", "Fv", "Fs", "off"};

namespace {

InertialVector Assemble(const Eigen::Matrix3d& tensor, const Eigen::Vector3d& first_moment, double mass) {
  InertialVector x;
  x << tensor(0, 0), tensor(0, 1), tensor(0, 2), tensor(1, 1), tensor(1, 2), tensor(2, 2), first_moment, mass;
  return x;
}

// integral of |p|^2 I - p p' for a unit mass at p.
Eigen::Matrix3d PointTensor(const Eigen::Vector3d& p) {
  return p.squaredNorm() * Eigen::Matrix3d::Identity() - p * p.transpose();
}

}  // namespace

InertialVector InertialFromCentreOfMass(double mass, const Eigen::Vector3d& centre_of_mass,
                                        const Eigen::Matrix3d& inertia_at_centre_of_mass) {
  return Assemble(inertia_at_centre_of_mass + mass * PointTensor(centre_of_mass), mass * centre_of_mass, mass);
}

Eigen::Matrix3d InertiaTensor(const InertialVector& x) {
  Eigen::Matrix3d tensor;
  tensor << x[kXX], x[kXY], x[kXZ], x[kXY], x[kYY], x[kYZ], x[kXZ], x[kYZ], x[kZZ];
  return tensor;
}

InertialVector TransformInertial(const InertialVector& in_b, const Eigen::Matrix3d& rotation,
                                 const Eigen::Vector3d& translation) {
  // The pseudo-inertia transforms like a second moment: T P T', with T the homogeneous pose. It stays valid for
  // zero and even for negative mass, where a centre of mass does not exist.
  Eigen::Matrix4d pose = Eigen::Matrix4d::Identity();
  pose.topLeftCorner<3, 3>() = rotation;
  pose.topRightCorner<3, 1>() = translation;
  return InertialFromPseudoInertia(pose * PseudoInertia(in_b) * pose.transpose());
}

Eigen::Matrix4d PseudoInertia(const InertialVector& x) {
  const Eigen::Matrix3d tensor = InertiaTensor(x);
  Eigen::Matrix4d pseudo;
  pseudo.topLeftCorner<3, 3>() = 0.5 * tensor.trace() * Eigen::Matrix3d::Identity() - tensor;
  pseudo.topRightCorner<3, 1>() = x.segment<3>(kMX);
  pseudo.bottomLeftCorner<1, 3>() = x.segment<3>(kMX).transpose();
  pseudo(3, 3) = x[kM];
  return pseudo;
}

InertialVector InertialFromPseudoInertia(const Eigen::Matrix4d& pseudo) {
  const Eigen::Matrix3d sigma = pseudo.topLeftCorner<3, 3>();
  return Assemble(sigma.trace() * Eigen::Matrix3d::Identity() - sigma, pseudo.topRightCorner<3, 1>(), pseudo(3, 3));
}

}  // namespace idim
