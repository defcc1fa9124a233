// Whole files in, whole files out: what a program writes is there completely or not at all.

#ifndef IDIM_CORE_BASE_FILE_H_
#define IDIM_CORE_BASE_FILE_H_

#include <string>
#include <vector>

#include "core/base/status.h"

namespace idim {

// The bytes of a file. BadInput naming the file when it is missing, a directory or unreadable.
Result<std::string> ReadFile(const std::string& path);

bool IsRegularFile(const std::string& path);

// The folder of a path, "." when it names none; and `path` itself when absolute, else folder/path, normalised.
std::string FolderOf(const std::string& path);
std::string ResolvePath(const std::string& folder, const std::string& path);

struct OutputFile {
  std::string name;  // within the output directory
  std::string content;
};

// Creates the directory if needed, writes every file under a temporary name in it, flushes them to the disk, and only
// when all are complete renames them one after the other. On failure before the renames the directory is as it was
// (removed again if this call created it). BadInput names the file and the reason.
Status WriteFiles(const std::string& directory, const std::vector<OutputFile>& files);

}  // namespace idim

#endif  // IDIM_CORE_BASE_FILE_H_
