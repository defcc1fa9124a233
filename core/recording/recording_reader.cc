// ReadRecording: from columns of CSV files to joint positions and control signals.

#include <glog/logging.h>

#include <Eigen/LU>
#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "core/base/text.h"
#include "core/recording/csv_reader.h"
#include "core/recording/study.h"

namespace idim {

namespace {

// One CSV file of a recording: what it is read for, and where that goes.
struct SourceFile {
  std::string path;
  CsvFirstLine first;
  std::vector<std::string> keys;   // "q1", ...: wanted from this file
  std::vector<CsvColumn> columns;  // of `keys`
  bool has_header = true;
  Eigen::MatrixXd values;  // rows x keys
};

class RecordingReader {
 public:
  RecordingReader(const Study& study, const RecordingEntry& entry)
      : study_(study), entry_(entry), n_(study.robot.dof()) {}

  Result<Recording> Read() {
    Status status = OpenFiles();
    if (status.ok()) status = ChooseSignal();
    if (status.ok()) status = Want();
    if (status.ok()) status = ReadFiles();
    if (status.ok()) status = Assemble();
    IDIM_RETURN_IF_ERROR(status);
    return std::move(recording_);
  }

 private:
  const Column* Declared(const std::string& key) const {
    for (const auto& [name, column] : study_.columns) {
      if (name == key) return &column;
    }
    return nullptr;
  }
  bool DeclaredAny(const std::string& kind) const {
    for (int j = 1; j <= n_; ++j) {
      if (Declared(kind + std::to_string(j)) != nullptr) return true;
    }
    return false;
  }
  static bool InHeader(const SourceFile& file, const std::string& name) {
    return std::count(file.first.fields.begin(), file.first.fields.end(), name) != 0;
  }

  Status OpenFiles() {
    for (const std::string& path : {entry_.q_file, entry_.signal_file, entry_.dq_file, entry_.ddq_file}) {
      if (path.empty() || files_.count(path) != 0) continue;
      Result<CsvFirstLine> first = ReadCsvFirstLine(path);
      IDIM_RETURN_IF_ERROR(first);
      files_[path].path = path;
      files_[path].first = *std::move(first);
    }
    return Status::Ok();
  }

  SourceFile& QFile() { return files_.at(entry_.q_file); }
  SourceFile& SignalFile() { return files_.at(entry_.signal_file); }

  Status ChooseSignal() {
    const SourceFile& file = SignalFile();
    const bool tau = entry_.signal_kind.empty()
                         ? DeclaredAny("tau") || (!DeclaredAny("v") && !InHeader(file, "v1") && InHeader(file, "tau1"))
                         : entry_.signal_kind == "tau";
    if (!tau) return Status::Ok();
    signal_ = "tau";
    recording_.signal_is_torque = true;
    const std::string at =
        file.path + ":" + std::to_string(file.first.line) + ": column 'tau1': joint torque is logged, ";
    if (study_.gains_mode != GainsMode::kKnown) {
      return Status::BadInput(at + "so there are no gains to identify; expected 'gains: {mode: known}' in " +
                              study_.path);
    }
    if ((study_.gains.array() != 1.0).any()) {
      return Status::BadInput(at + "so the gains are 1; expected no 'gains.values' in " + study_.path);
    }
    if (study_.signal_side != Side::kJoint) {
      return Status::BadInput(at + "not motor torque; expected 'signal_side: joint' in " + study_.path +
                              ", or columns v1.. for motor torque");
    }
    return Status::Ok();
  }

  Status Want() {
    SourceFile& q_file = QFile();
    if (Declared("t") != nullptr || InHeader(q_file, "t")) {
      q_file.keys.push_back("t");
    } else if (!study_.sample_rate) {
      return Status::BadInput(q_file.path + ":" + std::to_string(q_file.first.line) +
                              ": column 't': missing; expected a time column or 'sample_rate' in " + study_.path);
    }
    WantJoints("q", &q_file);
    WantJoints(signal_, &SignalFile());
    for (const auto& [kind, path] :
         {std::make_pair(std::string("dq"), entry_.dq_file), std::make_pair(std::string("ddq"), entry_.ddq_file)}) {
      SourceFile& file = path.empty() ? q_file : files_.at(path);
      if (!path.empty() || DeclaredAny(kind) || InHeader(file, kind + "1")) WantJoints(kind, &file);
    }
    for (auto& [path, file] : files_) {
      IDIM_RETURN_IF_ERROR(Resolve(&file));
    }
    return Status::Ok();
  }

  void WantJoints(const std::string& kind, SourceFile* file) {
    for (int j = 1; j <= n_; ++j) file->keys.push_back(kind + std::to_string(j));
  }

  // Keys -> columns of the file.
  Status Resolve(SourceFile* file) {
    const int width = static_cast<int>(file->first.fields.size());
    const std::string at = file->path + ":" + std::to_string(file->first.line) + ": ";
    const bool all_numbered = std::all_of(file->keys.begin(), file->keys.end(), [&](const std::string& key) {
      return Declared(key) != nullptr && Declared(key)->header.empty();
    });
    // With numbers alone a first line that holds a number is data, if need be with an error in it.
    file->has_header = all_numbered ? !file->first.any_number : true;
    std::map<int, std::string> taken;
    for (const std::string& key : file->keys) {
      const Column* const declared = Declared(key);
      CsvColumn column;
      if (declared != nullptr) {
        column.scale = declared->scale;
        column.offset = declared->offset;
      }
      const std::string wanted_for = declared == nullptr ? "" : " (" + key + ")";
      if (declared != nullptr && declared->header.empty()) {
        if (declared->number > width) {
          return Status::BadInput(at + "column " + std::to_string(declared->number) + wanted_for +
                                  ": missing; expected at least that many columns, the file has " +
                                  std::to_string(width));
        }
        column.index = declared->number - 1;
        column.label = "column " + std::to_string(declared->number) + wanted_for;
      } else {
        const std::string name = declared == nullptr ? key : declared->header;
        column.label = "column '" + name + "'" + wanted_for;
        const auto& fields = file->first.fields;
        const auto found = std::find(fields.begin(), fields.end(), name);
        if (found == fields.end()) return Status::BadInput(at + column.label + MissingColumn(*file, name));
        if (std::count(fields.begin(), fields.end(), name) > 1) {
          return Status::BadInput(at + column.label + ": the header has it more than once; expected distinct names");
        }
        column.index = static_cast<int>(found - fields.begin());
      }
      const auto [other, fresh] = taken.emplace(column.index, key);
      if (!fresh) {
        return Status::BadInput(at + column.label + ": is read as " + other->second +
                                " already; expected one column a signal");
      }
      file->columns.push_back(std::move(column));
    }
    return RefuseFurtherJoints(*file, at);
  }

  std::string MissingColumn(const SourceFile& file, const std::string& name) const {
    if (file.first.all_numbers) {
      return ": missing, the file has no header; expected a header line, or 'columns' by number in " + study_.path;
    }
    // A column that has a use of its own is not a misspelling of this one.
    std::vector<std::string> candidates;
    std::vector<std::string> shown;
    for (const std::string& field : file.first.fields) {
      if (std::count(file.keys.begin(), file.keys.end(), field) == 0) candidates.push_back(field);
      if (shown.size() < 24) shown.push_back(Clip(field));
    }
    const std::string nearest = NearestName(name, candidates);
    return ": missing" + (nearest.empty() ? "" : " (nearest: '" + Clip(nearest) + "')") +
           "; expected it in the header " + Join(shown, ",") + (shown.size() < file.first.fields.size() ? ",..." : "") +
           ", the robot has " + std::to_string(n_) + (n_ == 1 ? " joint" : " joints");
  }

  // A recording of an arm with more joints than the robot is another arm's.
  Status RefuseFurtherJoints(const SourceFile& file, const std::string& at) const {
    for (const std::string& kind : {std::string("q"), signal_}) {
      const std::string first = kind + "1";
      if (Declared(first) != nullptr || std::find(file.keys.begin(), file.keys.end(), first) == file.keys.end()) {
        continue;
      }
      const std::string further = kind + std::to_string(n_ + 1);
      if (InHeader(file, further)) {
        return Status::BadInput(at + "column '" + further + "': the robot '" + study_.robot.name + "' has " +
                                std::to_string(n_) + (n_ == 1 ? " joint" : " joints") + "; expected no more than " +
                                kind + std::to_string(n_));
      }
    }
    return Status::Ok();
  }

  Status ReadFiles() {
    for (auto& [path, file] : files_) {
      Result<Eigen::MatrixXd> values =
          ReadCsvColumns(path, file.has_header, static_cast<int>(file.first.fields.size()), file.columns);
      IDIM_RETURN_IF_ERROR(values);
      file.values = *std::move(values);
      const Eigen::Index rows = file.values.rows();
      if (rows < 2) {
        return Status::BadInput(path + ": has " + std::to_string(rows) + (rows == 1 ? " sample" : " samples") +
                                "; expected at least 2");
      }
    }
    const SourceFile& q_file = QFile();
    for (const auto& [path, file] : files_) {
      if (file.values.rows() != q_file.values.rows()) {
        return Status::BadInput(path + ": has " + std::to_string(file.values.rows()) + " samples, but " + q_file.path +
                                " has " + std::to_string(q_file.values.rows()) + "; expected files of equal length");
      }
    }
    return Status::Ok();
  }

  Status Assemble() {
    const SourceFile& q_file = QFile();
    const int rows = static_cast<int>(q_file.values.rows());
    Eigen::VectorXd t(rows);
    const Eigen::Index t_column = Find(q_file, "t");
    if (t_column >= 0) {
      t = q_file.values.col(t_column);
      for (int k = 1; k < rows; ++k) {
        if (t[k] > t[k - 1]) continue;
        return Status::BadInput(q_file.path + ":" + std::to_string(LineOfCsvRow(q_file.path, q_file.has_header, k)) +
                                ": " + q_file.columns[t_column].label + ": time " +
                                (t[k] == t[k - 1] ? "repeats" : "runs backwards") + ", " + FormatNumber(t[k]) +
                                " s after " + FormatNumber(t[k - 1]) + " s; expected strictly increasing times");
      }
    } else {
      for (int k = 0; k < rows; ++k) t[k] = k / *study_.sample_rate;
    }
    int begin = 0;
    int end = rows;
    if (entry_.rows) {
      std::tie(begin, end) = *entry_.rows;
      if (begin < 0 || end - begin < 2 || end > rows) {
        return Status::BadInput(q_file.path + ": rows [" + std::to_string(begin) + ", " + std::to_string(end) +
                                "] of recording '" + entry_.name + "' are not there; expected rows within [0, " +
                                std::to_string(rows) + "]");
      }
    }
    recording_.name = entry_.name;
    recording_.t = t.segment(begin, end - begin);
    recording_.q = ToJointSide(Signal("q", entry_.q_file, begin, end));
    recording_.signal = Signal(signal_, entry_.signal_file, begin, end);
    recording_.logged_dq =
        ToJointSide(Signal("dq", entry_.dq_file.empty() ? entry_.q_file : entry_.dq_file, begin, end));
    recording_.logged_ddq =
        ToJointSide(Signal("ddq", entry_.ddq_file.empty() ? entry_.q_file : entry_.ddq_file, begin, end));
    return Status::Ok();
  }

  static Eigen::Index Find(const SourceFile& file, const std::string& key) {
    const auto found = std::find(file.keys.begin(), file.keys.end(), key);
    return found == file.keys.end() ? -1 : found - file.keys.begin();
  }

  // Columns kind1..kindn, 0 x 0 where they were not wanted. WantJoints put them side by side.
  Eigen::MatrixXd Signal(const std::string& kind, const std::string& path, int begin, int end) const {
    const SourceFile& file = files_.at(path);
    const Eigen::Index first = Find(file, kind + "1");
    if (first < 0) return Eigen::MatrixXd();
    return file.values.block(begin, first, end - begin, n_);
  }

  Eigen::MatrixXd ToJointSide(const Eigen::MatrixXd& measured) const {
    if (study_.position_side == Side::kJoint || measured.size() == 0) return measured;
    return study_.robot.transmission.partialPivLu().solve(measured.transpose()).transpose();
  }

  const Study& study_;
  const RecordingEntry& entry_;
  const int n_;
  std::string signal_ = "v";
  std::map<std::string, SourceFile> files_;  // by path
  Recording recording_;
};

}  // namespace

Result<Recording> ReadRecording(const Study& study, const RecordingEntry& entry) {
  CHECK_EQ(study.robot.transmission.rows(), study.robot.dof());
  return RecordingReader(study, entry).Read();
}

}  // namespace idim
