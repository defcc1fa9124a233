// A TX-40 with random consistent bodies that moves along sines, known at any instant: the model so far for tests of
// effects, and the same torque by standard parameters for their independent computations.

#ifndef IDIM_TESTS_EFFECTS_EFFECT_ARM_H_
#define IDIM_TESTS_EFFECTS_EFFECT_ARM_H_

#include <cmath>
#include <string>
#include <vector>

#include "core/effects/effect_motion.h"
#include "tests/support/random_arm.h"

namespace idim::testing {

struct ArmState {
  Eigen::VectorXd q, dq, ddq;
};

class EffectArm {
 public:
  explicit EffectArm(const Robot& robot, double coulomb = 1.0)
      : random_(7), model_(robot, FrictionModel()), base_(model_) {
    const int n = robot.dof();
    standard_ = Eigen::VectorXd::Zero(model_.columns());
    for (int j = 0; j < n; ++j) {
      const std::string number = std::to_string(j + 1);
      standard_.segment<kNumInertial>(model_.Find("XX" + number)) = RandomBody(&random_);
      // Joints 1 and 2 regroup theirs into the links, where it cannot be told from them.
      if (j > 1) standard_[model_.Find("Ia" + number)] = random_.Uniform(0.05, 0.3);
      standard_[model_.Find("Fv" + number)] = random_.Uniform(1.0, 4.0);
      standard_[model_.Find("Fs" + number)] = coulomb * random_.Uniform(1.0, 4.0);
      standard_[model_.Find("off" + number)] = random_.Uniform(-1.0, 1.0);
    }
    if (model_.Find("Iam6") >= 0) standard_[model_.Find("Iam6")] = 0.02;
    amplitude_ = Eigen::MatrixXd::NullaryExpr(n, 2, [&] { return random_.Uniform(0.2, 0.8); });
    phase_ = Eigen::MatrixXd::NullaryExpr(n, 2, [&] { return random_.Uniform(-M_PI, M_PI); });
    frequency_ = Eigen::MatrixXd::NullaryExpr(n, 2, [&] { return random_.Uniform(1.0, 5.0); });  // [rad/s]
    sigma_ = Eigen::VectorXd::LinSpaced(n, 0.01, 0.03);
    payload_ = RandomBody(&random_);
  }

  ArmState State(double t) const {
    ArmState state;
    const Eigen::ArrayXXd angle = frequency_.array() * t + phase_.array();
    const Eigen::ArrayXXd w = frequency_.array(), a = amplitude_.array();
    state.q = (a * angle.sin()).rowwise().sum();
    state.dq = (a * w * angle.cos()).rowwise().sum();
    state.ddq = (-a * w.square() * angle.sin()).rowwise().sum();
    return state;
  }

  EffectMotion Motion(double begin, double step, int count, int recording = 0,
                      const Eigen::VectorXd& position_sigma = Eigen::VectorXd()) const {
    const int n = model_.dof();
    JointStates states;
    states.t = Eigen::VectorXd::LinSpaced(count, begin, begin + step * (count - 1));
    states.q.resize(count, n);
    states.dq = states.ddq = states.q;
    for (int i = 0; i < count; ++i) {
      const ArmState state = State(states.t[i]);
      states.q.row(i) = state.q;
      states.dq.row(i) = state.dq;
      states.ddq.row(i) = state.ddq;
    }
    return MakeEffectMotion(base_, std::make_shared<const JointStates>(states), recording, sigma_,
                            base_.projection() * standard_, payload_, position_sigma);
  }

  // By all standard parameters whose names do not begin with one of `without`, in any gravity.
  Eigen::VectorXd Torque(const ArmState& state, const std::vector<std::string>& without = {}) const {
    return Torque(model_.robot(), state, payload_, without);
  }
  Eigen::VectorXd Torque(const Robot& robot, const ArmState& state, const InertialVector& payload,
                         const std::vector<std::string>& without = {}) const {
    StandardModel model(robot, FrictionModel());
    Eigen::VectorXd chi = standard_;
    for (int c = 0; c < model.columns(); ++c) {
      for (const std::string& stem : without) {
        if (model.parameters()[c].name.rfind(stem, 0) == 0) chi[c] = 0.0;
      }
    }
    Eigen::VectorXd tau(model.dof());
    model.Torque(state.q.data(), state.dq.data(), state.ddq.data(), sigma_.data(), chi, payload, tau.data());
    return tau;
  }

  const Robot& robot() const { return base_.model().robot(); }
  const BaseParameters& base() const { return base_; }
  const StandardModel& model() const { return model_; }
  const Eigen::VectorXd& standard() const { return standard_; }
  const Eigen::VectorXd& sigma() const { return sigma_; }
  const InertialVector& payload() const { return payload_; }

 private:
  Random random_;
  StandardModel model_;
  BaseParameters base_;
  Eigen::VectorXd standard_, sigma_;
  Eigen::MatrixXd amplitude_, phase_, frequency_;
  InertialVector payload_;
};

inline const std::vector<std::string>& FrictionStems() {
  static const auto* const stems = new std::vector<std::string>{"Fv", "Fs", "off"};
  return *stems;
}

// All sets of joints that an effect of this site may stand on.
inline std::vector<std::vector<int>> SitesOf(const Effect& effect, int n) {
  std::vector<std::vector<int>> sites;
  if (effect.site() == EffectSite::kArm) sites.push_back({});
  for (int a = 0; a < n; ++a) {
    if (effect.site() == EffectSite::kJoint) sites.push_back({a});
    for (int b = a + 1; b < n && effect.site() == EffectSite::kJointPair; ++b) sites.push_back({a, b});
  }
  return sites;
}

// N x n: the column of one parameter, zero where there is no entry; the joints of a parameter's entries differ.
inline Eigen::MatrixXd ColumnOf(const std::string& id, const EffectMotion& motion, const std::vector<int>& joints,
                                const std::vector<double>& shape, int parameter = 0) {
  const Eigen::VectorXd values = Eigen::Map<const Eigen::VectorXd>(shape.data(), shape.size());
  Eigen::MatrixXd column = Eigen::MatrixXd::Zero(motion.t().size(), motion.robot->dof());
  for (const EffectEntry& entry : FindEffect(id)->Columns(motion, joints, values)) {
    if (entry.parameter == parameter) column.col(entry.joint) += entry.torque;
  }
  return column;
}

}  // namespace idim::testing

#endif  // IDIM_TESTS_EFFECTS_EFFECT_ARM_H_
