// The error channel of the library: bad data and untrustworthy results are values, not exceptions.
// A caller's bug (wrong matrix size passed to a function) is a CHECK instead.

#ifndef IDIM_CORE_BASE_STATUS_H_
#define IDIM_CORE_BASE_STATUS_H_

#include <optional>
#include <string>
#include <utility>

namespace idim {

// The values are the exit codes of the programs.
enum class StatusCode {
  kOk = 0,
  kBadInput = 1,   // a file, a key, an option: the user can mend it
  kUntrusted = 2,  // the data cannot tell: not identifiable, not converged, degenerate
};

class [[nodiscard]] Status {
 public:
  Status() = default;
  static Status Ok() { return Status(); }
  static Status BadInput(std::string message) { return Status(StatusCode::kBadInput, std::move(message)); }
  static Status Untrusted(std::string message) { return Status(StatusCode::kUntrusted, std::move(message)); }

  bool ok() const { return code_ == StatusCode::kOk; }
  StatusCode code() const { return code_; }
  int exit_code() const { return static_cast<int>(code_); }
  const std::string& message() const { return message_; }

 private:
  Status(StatusCode code, std::string message) : code_(code), message_(std::move(message)) {}

  StatusCode code_ = StatusCode::kOk;
  std::string message_;
};

// Either a value or a status that is not ok.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}          // NOLINT(google-explicit-constructor)
  Result(Status status) : status_(std::move(status)) {}  // NOLINT(google-explicit-constructor)

  bool ok() const { return value_.has_value(); }
  const Status& status() const { return status_; }

  const T& value() const& { return value_.value(); }
  T& value() & { return value_.value(); }
  T&& value() && { return std::move(value_).value(); }
  const T& operator*() const& { return *value_; }
  T& operator*() & { return *value_; }
  const T* operator->() const { return &*value_; }
  T* operator->() { return &*value_; }

 private:
  Status status_;
  std::optional<T> value_;
};

inline const Status& StatusOf(const Status& status) { return status; }
// Of a Result, or of what else has a status: a file being read.
template <typename T>
const Status& StatusOf(const T& outcome) {
  return outcome.status();
}

}  // namespace idim

// Returns what StatusOf() says of an outcome that is not ok, from a function that returns a Status or a Result.
#define IDIM_RETURN_IF_ERROR(expression)                               \
  do {                                                                 \
    if (const auto& idim_outcome = (expression); !idim_outcome.ok()) { \
      return ::idim::StatusOf(idim_outcome);                           \
    }                                                                  \
  } while (false)

#endif  // IDIM_CORE_BASE_STATUS_H_
