// What was measured: recordings with their joint states and decimators, made once, shared and never changed.

#ifndef IDIM_CORE_MODEL_DATA_H_
#define IDIM_CORE_MODEL_DATA_H_

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "core/base/status.h"
#include "core/motion/preprocessing.h"
#include "core/recording/study.h"
#include "core/robot/drive_map.h"

namespace idim {

// All that a study says of its measurements.
struct DataRequest {
  std::string path;  // of the study, for messages
  Robot robot;
  Side signal_side = Side::kJoint;
  std::vector<RecordingEntry> recordings;
  Eigen::VectorXd position_noise;  // n [rad or m] a priori standard deviation of a sample; empty: estimated
  Eigen::VectorXd signal_noise;    // n [signal unit] likewise; empty: not known
  PreprocessingRequest preprocessing;
};

DataRequest DataRequestOf(const Study& study);

struct MeasuredRecording {
  RecordingEntry entry;
  std::shared_ptr<const Recording> recording;
  std::shared_ptr<const JointStates> states;
  std::shared_ptr<const Decimator> decimator;
};

struct Data {
  DataRequest request;
  DriveMap drive;
  std::vector<MeasuredRecording> recordings;
  Preprocessing preprocessing;         // the same for all recordings, so that all equations see one filter
  Eigen::VectorXd position_noise;      // n [rad or m] a sample, a priori or estimated
  Eigen::VectorXd velocity_sigma;      // n [rad/s or m/s], of the undecimated dq
  Eigen::VectorXd position_sigma;      // n [rad or m], of the undecimated q
  bool velocity_zero_at_rest = false;  // WithVelocityZeroAtRest()

  const Robot& robot() const { return request.robot; }
  const std::string& path() const { return request.path; }
};

// Chooses the filter where the request does not, estimates the joint states. recordings: one an entry of the request
// in its order (CHECK). BadInput: as the filters say. Untrusted: a joint that moves in no identification recording.
Result<std::shared_ptr<const Data>> MakeData(const DataRequest& request, std::vector<Recording> recordings);

// Zero-velocity update: where for a while (0.1 s and two periods of the cut-off) velocity is within 4 standard
// deviations of zero and position within 8 of one place, the velocity is zero. The sign of the noise there is no
// friction, but as a function of the measured velocity it would pass for one. For tracing; estimators take velocities
// as measured, which on the real TX-40 makes less than 3 % of any joint's error.
std::shared_ptr<const Data> WithVelocityZeroAtRest(const Data& data);

// Some of the recordings, in this order; they are shared, filter and noise are those of all.
std::shared_ptr<const Data> SomeRecordings(const Data& data, const std::vector<int>& indices);

}  // namespace idim

#endif  // IDIM_CORE_MODEL_DATA_H_
