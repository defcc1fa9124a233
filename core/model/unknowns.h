// The unknowns of a model in their one order, and what a vector of their values means:
//
//   [drive gains | base parameters | effects | payloads]
//
// Gains g1..gn where they are identified. Of each effect its linear parameters, then a step for each of its shapes
// that is free (core/model/active_effects.h). Of each payload that an identification recording carries the unknown ones
// of its ten parameters (paper II.B, eq. (5)), named like the paper's link n + 1 ("XX7", "M7"; "XX7_big" where several
// payloads are carried).

#ifndef IDIM_CORE_MODEL_UNKNOWNS_H_
#define IDIM_CORE_MODEL_UNKNOWNS_H_

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/dynamics/parameters.h"
#include "core/model/model.h"
#include "core/robot/inertia.h"

namespace idim {

// All that a torque of the model depends on.
struct ArmParameters {
  Eigen::VectorXd gains;                 // n [N m or N per signal unit]
  Eigen::VectorXd chi;                   // base parameters, then those of Model::columns
  std::vector<InertialVector> payloads;  // one a payload of the model, in the frame of the last link

  // What a recording carries, zero for nothing.
  InertialVector Carried(const RecordingRole& role) const {
    return role.payload < 0 ? InertialVector(InertialVector::Zero()) : payloads[static_cast<size_t>(role.payload)];
  }
};

// g1..gn.
std::vector<Parameter> GainParameters(const Robot& robot, Side signal_side);

// A payload parameter that is known to a standard deviation only: taken for exact, or an unknown (to be given a prior).
enum class UncertainPayload { kExact, kUnknown };

class Unknowns {
 public:
  Unknowns() = default;
  Unknowns(const Model& model, UncertainPayload uncertain);

  const std::vector<Parameter>& parameters() const { return parameters_; }
  const Parameter& operator[](int k) const { return parameters_[static_cast<size_t>(k)]; }
  int size() const { return static_cast<int>(parameters_.size()); }
  // Index of a name; nothing: it is no unknown.
  std::optional<int> Find(const std::string& name) const;

  int dof() const { return dof_; }
  int num_gains() const { return known_gains_.size() > 0 ? 0 : dof_; }  // unknown ones
  int num_base() const { return num_base_; }
  int num_effect_parameters() const { return num_effect_; }
  // Columns of a torque: all unknowns but the gains, in their order.
  int num_columns() const { return size() - num_gains(); }
  // The first base parameter and the first parameter of an effect.
  int first_base() const { return num_gains(); }
  int first_effect() const { return num_gains() + num_base_; }

  // Where the unknowns of effect e are: `linear` parameters from `at`, then the steps of `shapes` of its shapes.
  struct EffectRange {
    int at = 0, linear = 0, shapes = 0;
    int end() const { return at + linear + shapes; }
  };
  const EffectRange& effect(size_t e) const { return effects_[e]; }
  size_t num_effects() const { return effects_.size(); }

  int num_payloads() const { return static_cast<int>(payload_index_.size()); }
  // Index of parameter k of a payload (-1: none); -1: known, or not carried.
  int payload(int payload, int k) const {
    return payload < 0 ? -1 : payload_index_[static_cast<size_t>(payload)][static_cast<size_t>(k)];
  }
  // What is known of a payload, zero where unknown and for payload -1.
  InertialVector known_payload(int payload) const {
    return payload < 0 ? InertialVector(InertialVector::Zero()) : known_payload_[static_cast<size_t>(payload)];
  }

  // n, of the unknowns theta or known.
  Eigen::VectorXd Gains(const Eigen::VectorXd& theta) const {
    return known_gains_.size() > 0 ? known_gains_ : Eigen::VectorXd(theta.head(dof_));
  }
  // The arm at theta (size()).
  ArmParameters Arm(const Eigen::VectorXd& theta) const;
  // The other way.
  Eigen::VectorXd Values(const ArmParameters& arm) const;
  // What an estimate states beyond the value of unknown k: of the step of a shape the shape that it starts from.
  double Offset(int k) const { return offsets_[k]; }

  // The same unknowns with gains known to be these.
  Unknowns WithKnownGains(const Eigen::VectorXd& gains) const;

 private:
  int dof_ = 0, num_base_ = 0, num_effect_ = 0;
  std::vector<Parameter> parameters_;
  Eigen::VectorXd offsets_;
  Eigen::VectorXd known_gains_;  // n, or empty
  std::vector<EffectRange> effects_;
  std::vector<std::array<int, kNumInertial>> payload_index_;
  std::vector<InertialVector> known_payload_;
};

}  // namespace idim

#endif  // IDIM_CORE_MODEL_UNKNOWNS_H_
