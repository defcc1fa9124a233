#include "core/recording/data_path.h"

#include <cstdlib>
#include <filesystem>

#include "core/base/file.h"

namespace idim {

std::vector<std::string> DataPathCandidates(const std::string& study_path, const std::string& file) {
  namespace fs = std::filesystem;
  if (fs::path(file).is_absolute()) return {file};
  std::vector<std::string> candidates = {ResolvePath(FolderOf(study_path), file)};
  const char* const data_dir = std::getenv("IDIM_DATA_DIR");
  if (data_dir != nullptr && *data_dir != '\0') candidates.push_back(ResolvePath(data_dir, file));
  std::error_code error;
  const fs::path study = fs::absolute(study_path, error).lexically_normal();
  // What lies in the file system's root is not the user's.
  for (fs::path folder = study.parent_path(); folder.has_relative_path(); folder = folder.parent_path()) {
    candidates.push_back(ResolvePath((folder / "recordings").string(), file));
    candidates.push_back(ResolvePath((folder / "shared/datasets").string(), file));
  }
  return candidates;
}

std::string FindDataFile(const std::string& study_path, const std::string& file) {
  for (const std::string& candidate : DataPathCandidates(study_path, file)) {
    if (IsRegularFile(candidate)) return candidate;
  }
  return std::string();
}

}  // namespace idim
