// Where the public recordings are on this machine, for tests that read them and are skipped without them.

#ifndef IDIM_TESTS_SUPPORT_SHARED_RECORDINGS_H_
#define IDIM_TESTS_SUPPORT_SHARED_RECORDINGS_H_

#include <string>

#include "core/recording/data_path.h"

inline std::string FindPublicRecording(const std::string& file) {
  return idim::FindDataFile(IDIM_SOURCE_DIR "/datasets/tx40/study.yaml", file);
}

#define IDIM_SKIP_WITHOUT(file)                                            \
  do {                                                                     \
    if (FindPublicRecording(file).empty()) {                               \
      GTEST_SKIP() << "skipped: the public recording " << (file)           \
                   << " is not here; scripts/fetch_recordings.sh gets it"; \
    }                                                                      \
  } while (false)

#endif  // IDIM_TESTS_SUPPORT_SHARED_RECORDINGS_H_
