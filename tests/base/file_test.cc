#include "core/base/file.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/support/temp_folder.h"

namespace idim::file_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::vector<std::string> Names(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(WriteFiles, MakesTheDirectoryAndLeavesOnlyTheFiles) {
  const TempFolder folder;
  const std::string binary("a\0b\n", 4);
  ASSERT_TRUE(WriteFiles(folder / "deep/out", {{"one.json", "{}"}, {"two.csv", binary}}).ok());
  EXPECT_THAT(Names(folder / "deep/out"), ::testing::ElementsAre("one.json", "two.csv"));
  const Result<std::string> back = ReadFile(folder / "deep/out/two.csv");
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(*back, binary);
}

TEST(WriteFiles, ReplacesWhatIsThere) {
  const TempFolder folder;
  folder.Write("one", "a much longer former content");
  ASSERT_TRUE(WriteFiles(folder.path(), {{"one", "new"}}).ok());
  EXPECT_EQ(*ReadFile(folder / "one"), "new");
}

TEST(WriteFiles, OneFailureLeavesEverythingAsItWas) {
  const TempFolder folder;
  folder.Write("one", "old");
  fs::create_directory(folder / "two");  // cannot be replaced by a file
  const Status status = WriteFiles(folder.path(), {{"one", "new"}, {"two", "new"}});
  EXPECT_EQ(status.code(), StatusCode::kBadInput);
  EXPECT_THAT(status.message(), HasSubstr(folder / "two"));
  EXPECT_EQ(*ReadFile(folder / "one"), "old");
  EXPECT_THAT(Names(folder.path()), ::testing::ElementsAre("one", "two"));
}

TEST(WriteFiles, FailureRemovesTheDirectoriesItMade) {
  const TempFolder folder;
  // The name lies in a folder that does not exist, so that writing fails after the directory was made.
  const Status status = WriteFiles(folder / "a/b/", {{"good", "x"}, {"absent/file", "x"}});
  EXPECT_EQ(status.code(), StatusCode::kBadInput);
  EXPECT_THAT(Names(folder.path()), ::testing::IsEmpty());
}

TEST(WriteFiles, DirectoryThatCannotBeMade) {
  const TempFolder folder;
  folder.Write("file", "x");
  const Status status = WriteFiles(folder / "file/out", {{"one", "x"}});
  EXPECT_EQ(status.exit_code(), 1);
  EXPECT_THAT(status.message(), HasSubstr(folder / "file/out"));
}

TEST(ReadFile, MissingAndDirectory) {
  const TempFolder folder;
  EXPECT_THAT(ReadFile(folder / "none").status().message(), HasSubstr("No such file"));
  EXPECT_THAT(ReadFile(folder.path()).status().message(), HasSubstr("is a directory"));
}

}  // namespace
}  // namespace idim::file_test
