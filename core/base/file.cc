#include "core/base/file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

namespace idim {

namespace fs = std::filesystem;

namespace {

std::string Reason(int error) { return std::strerror(error); }

Status WriteWhole(const std::string& path, const std::string& content) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file < 0) return Status::BadInput(path + ": cannot be created: " + Reason(errno));
  size_t written = 0;
  int error = 0;
  while (written < content.size() && error == 0) {
    const ssize_t count = ::write(file, content.data() + written, content.size() - written);
    if (count >= 0) {
      written += static_cast<size_t>(count);
    } else if (errno != EINTR) {
      error = errno;
    }
  }
  // The rename must not reach the disk before the content does.
  if (error == 0 && ::fsync(file) != 0 && errno != EINVAL) error = errno;
  if (::close(file) != 0 && error == 0) error = errno;
  if (error != 0) return Status::BadInput(path + ": cannot be written: " + Reason(error));
  return Status::Ok();
}

}  // namespace

Result<std::string> ReadFile(const std::string& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return Status::BadInput(path + ": is a directory; expected a file");
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (file == nullptr) return Status::BadInput(path + ": cannot be read: " + Reason(errno));
  std::string content;
  char buffer[1 << 16];
  while (const size_t count = std::fread(buffer, 1, sizeof(buffer), file.get())) content.append(buffer, count);
  if (std::ferror(file.get()) != 0) return Status::BadInput(path + ": cannot be read: " + Reason(errno));
  return content;
}

bool IsRegularFile(const std::string& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

std::string FolderOf(const std::string& path) {
  const std::string folder = fs::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

std::string ResolvePath(const std::string& folder, const std::string& path) {
  return (fs::path(folder) / path).lexically_normal().string();
}

Status WriteFiles(const std::string& directory, const std::vector<OutputFile>& files) {
  std::error_code error;
  fs::path deepest = fs::absolute(directory, error).lexically_normal();
  if (!deepest.has_filename()) deepest = deepest.parent_path();  // a trailing slash
  // The topmost folder that this call creates, to take it away again on failure.
  fs::path created;
  for (fs::path folder = deepest; !folder.empty() && !fs::exists(folder, error); folder = folder.parent_path()) {
    created = folder;
  }
  fs::create_directories(directory, error);
  if (error) return Status::BadInput(directory + ": cannot be created: " + error.message());

  const std::string suffix = ".tmp" + std::to_string(::getpid());
  const auto temporary = [&](const OutputFile& file) {
    return (fs::path(directory) / ("." + file.name + suffix)).string();
  };
  Status status;
  for (const OutputFile& file : files) {
    const fs::path target = fs::path(directory) / file.name;
    if (fs::is_directory(target, error)) {
      status = Status::BadInput(target.string() + ": is a directory; expected a file or nothing");
    } else {
      status = WriteWhole(temporary(file), file.content);
    }
    if (!status.ok()) break;
  }
  for (size_t i = 0; i < files.size() && status.ok(); ++i) {
    const fs::path target = fs::path(directory) / files[i].name;
    fs::rename(temporary(files[i]), target, error);
    if (error) status = Status::BadInput(target.string() + ": cannot be written: " + error.message());
  }
  if (!status.ok()) {
    for (const OutputFile& file : files) fs::remove(temporary(file), error);
    // Only folders that this call made, and only while they are empty.
    for (fs::path folder = deepest; !created.empty(); folder = folder.parent_path()) {
      if (!fs::remove(folder, error) || folder == created) break;
    }
  }
  return status;
}

}  // namespace idim
