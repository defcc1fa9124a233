// study.yaml: a robot, its recordings, what is known of payloads, gains and drives, and how to filter.

#ifndef IDIM_CORE_RECORDING_STUDY_H_
#define IDIM_CORE_RECORDING_STUDY_H_

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/status.h"
#include "core/dynamics/standard_model.h"
#include "core/recording/recording.h"
#include "core/robot/drive_map.h"
#include "core/robot/robot.h"

namespace idim {

enum class Use { kIdentification, kValidation };

// The known ones among the ten inertial parameters, about the frame of the last link; the others are identified.
struct Payload {
  std::string name;
  std::array<std::optional<double>, kNumInertial> known;
  // Of the known ones, those known to a standard deviation only; absent: exact.
  std::array<std::optional<double>, kNumInertial> standard_deviation;
};

// What is known beforehand of an identified parameter, by its name in estimate.json.
struct Prior {
  std::string parameter;
  double value = 0.0;
  double standard_deviation = 0.0;  // > 0
  std::string where;                // "file:line: key '...'", for messages
};

// Where a signal is found in a file: a header name or a 1-based number, then value = scale * column + offset.
struct Column {
  std::string header;  // empty: `number` counts
  int number = 0;      // 1-based
  double scale = 1.0;
  double offset = 0.0;
};

struct RecordingEntry {
  std::string name;
  Use use = Use::kIdentification;
  int payload = -1;    // index into Study::payloads, -1: none
  std::string q_file;  // resolved paths; equal unless signals are kept in separate files
  std::string signal_file;
  std::string dq_file;  // empty: where q is
  std::string ddq_file;
  // "v" or "tau" where `files` says which the signal file holds; empty: the columns tell.
  std::string signal_kind;
  // Zero-based half-open range of the data rows to use (key `rows`); absent: all.
  std::optional<std::pair<int, int>> rows;
};

// A start value for a shape parameter. Names and limits depend on the motion:
// solvers/loop/declared_effects.h checks them.
struct DeclaredShape {
  std::string name;
  double value = 0.0;
  std::string where;  // "file:line: key '...'", for messages
};

// An effect that the user declares to be there, as written: core/effects/placed_effects.h knows what it may be.
struct DeclaredEffect {
  std::string id;
  std::vector<int> joints;           // zero-based; [1, 2] of a joint's effect is one on each
  std::vector<DeclaredShape> shape;  // empty: to be found
  std::string where;                 // "file:line: key '...'", for messages
  std::string id_where, joints_where;
};

struct PreprocessingRequest {
  std::optional<double> cutoff_hz;
  std::optional<int> decimation;
};

enum class GainsMode { kKnown, kIdentify };

struct Study {
  std::string path;
  Robot robot;
  std::vector<RecordingEntry> recordings;
  std::vector<Payload> payloads;
  GainsMode gains_mode = GainsMode::kKnown;
  // n, [N.m or N per signal unit]. Known mode: exact (default 1). Identify mode: a priori values or empty.
  Eigen::VectorXd gains;
  std::vector<Prior> priors;
  FrictionModel friction;
  std::vector<DeclaredEffect> effects;
  Side position_side = Side::kJoint;
  Side signal_side = Side::kJoint;
  // Keyed like the contract: "t", "q1", "v1", "tau1", "dq1", "ddq1"; only those the study declares.
  std::vector<std::pair<std::string, Column>> columns;
  std::optional<double> sample_rate;  // [Hz]
  Eigen::VectorXd position_noise;     // [rad or m] a priori standard deviation per joint, or empty
  Eigen::VectorXd signal_noise;       // [signal unit] likewise
  PreprocessingRequest preprocessing;
};

// Paths are relative to the study; a recording that is not there is looked for in $IDIM_DATA_DIR, then in
// `recordings/` (where scripts/fetch_recordings.sh puts them) and `shared/datasets/` of every folder above the study.
//
// Defaults: gains known and 1; friction viscous, coulomb, offset; both sides joint; a recording's name is that of its
// file without the extension, its use identification. Refused, naming file, line and key: unknown keys (with the
// nearest known one), wrong types and lengths, values that are not finite, a recording that is nowhere, names given
// twice, an undeclared payload, no identification recording, effects at joints that there are not.
Result<Study> ReadStudy(const std::string& yaml_path);

// Reads the files of one entry and maps positions to the joint side (motor side: q = T^-1 q_motor, dq and ddq alike).
//
// Columns: those that the study declares, else the headers t, q1..qn, v1..vn (or tau1..taun), dq1.., ddq1... A file
// has no header when its first line is all numbers; then every column it is read for must be declared by number. Time
// is column t of the position file; without one it is row / sample_rate. dq and ddq are read when declared, given a
// file, or found in the header of the position file. `v` wins where a file holds both v and tau.
//
// Refuses, naming file and line: a wrong number of columns, text, NaN, inf or |value| > 1e12, time that repeats or
// runs backwards, a truncated last line, fewer than 2 samples, files of different length, columns that are missing or
// belong to a joint that the robot lacks, tau with gains that are not known and 1 or with signal_side motor.
Result<Recording> ReadRecording(const Study& study, const RecordingEntry& entry);

}  // namespace idim

#endif  // IDIM_CORE_RECORDING_STUDY_H_
