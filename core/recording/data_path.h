// Where a recording lies: beside its study, or where measured data that are not committed are kept.

#ifndef IDIM_CORE_RECORDING_DATA_PATH_H_
#define IDIM_CORE_RECORDING_DATA_PATH_H_

#include <string>
#include <vector>

namespace idim {

// The places of a file named in a study, in the order in which they are tried: beside the study; in $IDIM_DATA_DIR;
// then, from the folder of the study upwards, in `recordings/` and `shared/datasets/` of each folder below the file
// system's root. An absolute path has one place only.
std::vector<std::string> DataPathCandidates(const std::string& study_path, const std::string& file);

// The first candidate that is a regular file; "" if none is.
std::string FindDataFile(const std::string& study_path, const std::string& file);

}  // namespace idim

#endif  // IDIM_CORE_RECORDING_DATA_PATH_H_
