#include "core/recording/check_study.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "core/robot/check_robot.h"

namespace idim {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kLargestValue = 1e12;

class Checker {
 public:
  explicit Checker(Study* study) : study_(*study), n_(study->robot.dof()) {}

  Status Run() {
    CheckPayloads();
    CheckRecordings();
    CheckGains();
    CheckPriors();
    CheckEffects();
    CheckDeviations("position_noise", study_.position_noise);
    CheckDeviations("signal_noise", study_.signal_noise);
    if (study_.sample_rate) CheckPositive("sample_rate", *study_.sample_rate);
    if (study_.preprocessing.cutoff_hz) CheckPositive("preprocessing.cutoff_hz", *study_.preprocessing.cutoff_hz);
    if (study_.preprocessing.decimation.value_or(1) < 1) {
      Fail("preprocessing.decimation", "is " + std::to_string(*study_.preprocessing.decimation), "1 or more");
    }
    return status_;
  }

 private:
  void Fail(const std::string& field, const std::string& problem, const std::string& expected) {
    if (!status_.ok()) return;
    status_ = Status::BadInput(study_.path + ": " + field + " " + problem + "; expected " + expected);
  }

  static std::string Item(const char* list, size_t k) { return std::string(list) + "[" + std::to_string(k) + "]"; }

  // Written negatively, so that NaN fails.
  void CheckPositive(const std::string& field, double value) {
    if (!(value > 0.0 && std::isfinite(value))) Fail(field, "is " + FormatNumber(value), "a finite number above 0");
  }

  void CheckDeviations(const std::string& field, const VectorXd& values) {
    if (values.size() == 0) return;
    if (values.size() != n_ || !(values.array() > 0.0).all() || !values.allFinite()) {
      Fail(field, "has " + std::to_string(values.size()) + " numbers, or one that is not above 0",
           std::to_string(n_) + " finite standard deviations above 0, or none");
    }
  }

  void CheckPayloads() {
    for (size_t p = 0; p < study_.payloads.size(); ++p) {
      const Payload& payload = study_.payloads[p];
      const std::string field = Item("payloads", p);
      if (payload.name.empty()) Fail(field + ".name", "is empty", "a name");
      for (size_t other = 0; other < p; ++other) {
        if (study_.payloads[other].name == payload.name) Fail(field + ".name", "is given twice", "distinct names");
      }
      for (int k = 0; k < kNumInertial; ++k) {
        const auto& known = payload.known[static_cast<size_t>(k)];
        const auto& deviation = payload.standard_deviation[static_cast<size_t>(k)];
        const std::string value = field + ".known[" + kStandardNames[static_cast<size_t>(k)] + "]";
        if (known && k == kM) CheckPositive(value, *known);
        const bool moment = k == kXX || k == kYY || k == kZZ;
        if (known && (!std::isfinite(*known) || (moment && *known < 0.0))) {
          Fail(value, "is " + FormatNumber(*known), moment ? "a moment of inertia >= 0" : "a finite number");
        }
        if (!deviation) continue;
        CheckPositive(field + ".standard_deviation", *deviation);
        if (!known) Fail(value, "is missing, but has a standard deviation", "its value");
      }
    }
  }

  void CheckRecordings() {
    if (study_.recordings.empty()) Fail("recordings", "is empty", "one or more, one of them for identification");
    bool any = false;
    for (size_t k = 0; k < study_.recordings.size(); ++k) {
      RecordingEntry& entry = study_.recordings[k];
      const std::string field = Item("recordings", k);
      if (entry.name.empty()) entry.name = std::filesystem::path(entry.q_file).stem().string();
      if (entry.name.empty()) entry.name = "recording" + std::to_string(k + 1);
      // Messages about a recording name its file.
      if (entry.q_file.empty()) entry.q_file = entry.signal_file = entry.name;
      for (size_t other = 0; other < k; ++other) {
        if (study_.recordings[other].name == entry.name) {
          Fail(field + ".name", "'" + entry.name + "' is given twice", "distinct names");
        }
      }
      if (entry.payload < -1 || entry.payload >= static_cast<int>(study_.payloads.size())) {
        Fail(field + ".payload", "is " + std::to_string(entry.payload),
             "-1 or an index into the " + std::to_string(study_.payloads.size()) + " payloads");
      }
      if (entry.rows && (entry.rows->first < 0 || entry.rows->second - entry.rows->first < 2)) {
        Fail(field + ".rows", "is too short", "begin and end (exclusive) of at least 2 rows");
      }
      any |= entry.use == Use::kIdentification;
    }
    if (!any) Fail("recordings", "has none for identification", "one or more with use kIdentification");
  }

  void CheckGains() {
    const bool known = study_.gains_mode == GainsMode::kKnown;
    if (known && study_.gains.size() == 0) study_.gains = VectorXd::Ones(n_);
    if (study_.gains.size() == 0) return;
    if (study_.gains.size() != n_) {
      Fail("gains", "has " + std::to_string(study_.gains.size()) + " values",
           std::to_string(n_) + " of them" + (known ? ", or none for 1" : ", or none"));
    } else if (!study_.gains.allFinite() || (study_.gains.array() == 0.0).any()) {
      Fail("gains", "has a value that is 0 or not finite", "N.m (or N) per signal unit, other than 0");
    }
  }

  void CheckPriors() {
    for (size_t k = 0; k < study_.priors.size(); ++k) {
      Prior& prior = study_.priors[k];
      const std::string field = Item("priors", k);
      if (prior.where.empty()) prior.where = study_.path + ": " + field;
      if (prior.parameter.empty()) Fail(field + ".parameter", "is empty", "a name as in estimate.json");
      if (!std::isfinite(prior.value)) Fail(field + ".value", "is not finite", "a number");
      CheckPositive(field + ".standard_deviation", prior.standard_deviation);
      for (size_t other = 0; other < k; ++other) {
        if (study_.priors[other].parameter == prior.parameter) {
          Fail(field, "'" + prior.parameter + "' is given twice", "one prior a parameter");
        }
      }
    }
  }

  // What an effect may be asked, core/effects/placed_effects.h knows.
  void CheckEffects() {
    for (size_t k = 0; k < study_.effects.size(); ++k) {
      DeclaredEffect& effect = study_.effects[k];
      const std::string field = Item("effects", k), where = study_.path + ": " + field;
      if (effect.where.empty()) effect.where = where;
      if (effect.id_where.empty()) effect.id_where = where + ".id";
      if (effect.joints_where.empty()) effect.joints_where = where + ".joints";
      for (const int joint : effect.joints) {
        if (joint >= 0 && joint < n_) continue;
        Fail(field + ".joints", "holds " + std::to_string(joint), "0 to " + std::to_string(n_ - 1));
      }
      for (DeclaredShape& shape : effect.shape) {
        if (shape.where.empty()) shape.where = where + ".shape." + shape.name;
        if (!std::isfinite(shape.value)) Fail(field + ".shape." + shape.name, "is not finite", "a number");
      }
    }
  }

  Study& study_;
  const int n_;
  Status status_ = Status::Ok();
};

}  // namespace

Result<Study> CheckedStudy(Study study) {
  if (study.path.empty()) study.path = "study";
  Result<Robot> robot = CheckedRobot(std::move(study.robot));
  if (!robot.ok()) return Status::BadInput(study.path + ": " + robot.status().message());
  study.robot = *std::move(robot);
  IDIM_RETURN_IF_ERROR(Checker(&study).Run());
  return study;
}

Status CheckRecording(const Study& study, const Recording& recording) {
  const auto refuse = [&](const std::string& field, const std::string& problem, const std::string& expected) {
    return Status::BadInput(study.path + ": recording '" + recording.name + "': " + field + " " + problem +
                            "; expected " + expected);
  };
  const Index samples = recording.t.size(), n = study.robot.dof();
  if (samples < 2) return refuse("t", "has " + std::to_string(samples) + " samples", "at least 2");
  const struct {
    const char* name;
    const MatrixXd& values;
    bool may_be_empty;
  } parts[] = {{"q", recording.q, false},
               {"signal", recording.signal, false},
               {"logged_dq", recording.logged_dq, true},
               {"logged_ddq", recording.logged_ddq, true}};
  for (const auto& [name, values, may_be_empty] : parts) {
    if (may_be_empty && values.size() == 0) continue;
    if (values.rows() != samples || values.cols() != n) {
      return refuse(name, "is " + std::to_string(values.rows()) + " x " + std::to_string(values.cols()),
                    std::to_string(samples) + " x " + std::to_string(n) + ", a row a sample and a column a joint");
    }
    if (!(values.array().abs() <= kLargestValue).all()) {
      return refuse(name, "has a value that is not finite or beyond 1e12", "numbers in rad, m or signal units");
    }
  }
  if (!(recording.t.array().abs() <= kLargestValue).all() ||
      !((recording.t.tail(samples - 1) - recording.t.head(samples - 1)).array() > 0.0).all()) {
    return refuse("t", "does not increase from sample to sample", "seconds, strictly increasing");
  }
  const bool unit_gains = study.gains_mode == GainsMode::kKnown && (study.gains.array() == 1.0).all();
  if (recording.signal_is_torque && (!unit_gains || study.signal_side != Side::kJoint)) {
    return refuse("signal", "is torque", "gains that are known and 1, and signals on the joint side");
  }
  return Status::Ok();
}

}  // namespace idim
