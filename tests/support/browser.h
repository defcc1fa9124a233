// Opens a report in headless Chromium and says what of it was drawn.

#ifndef IDIM_TESTS_SUPPORT_BROWSER_H_
#define IDIM_TESTS_SUPPORT_BROWSER_H_

#include <stdlib.h>  // mkdtemp
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "core/base/status.h"

namespace idim::testing {

// What the page says of itself (see RenderReport) once its scripts have run.
struct DrawnReport {
  int figures_expected = -1;
  int figures_drawn = -1;
  int script_errors = -1;
  std::vector<bool> figure_drawn;  // in the order of the page

  bool AllDrawn() const {
    return figures_expected > 0 && figures_drawn == figures_expected && script_errors == 0 &&
           static_cast<int>(figure_drawn.size()) == figures_expected;
  }
};

// Path of Chromium or Chrome, from $IDIM_CHROMIUM or $PATH; none: the test is to GTEST_SKIP.
inline std::optional<std::string> FindChromium() {
  std::vector<std::filesystem::path> candidates;
  if (const char* named = std::getenv("IDIM_CHROMIUM")) candidates.emplace_back(named);
  const char* path = std::getenv("PATH");
  const std::string folders = path ? path : "";
  for (std::size_t begin = 0; begin < folders.size();) {
    const std::size_t end = std::min(folders.find(':', begin), folders.size());
    for (const char* name : {"chromium", "chromium-browser", "google-chrome"}) {
      candidates.push_back(std::filesystem::path(folders.substr(begin, end - begin)) / name);
    }
    begin = end + 1;
  }
  std::error_code ignored;
  for (const std::filesystem::path& candidate : candidates) {
    if (std::filesystem::is_regular_file(candidate, ignored)) return candidate.string();
  }
  return std::nullopt;
}

inline std::string ReadWholeFile(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// Runs the page's scripts for up to a minute of the page's time (seconds of ours) and reads the document that is left.
// Not ok: Chromium did not run, or the document does not look like a report.
inline Result<DrawnReport> OpenReport(const std::string& chromium, const std::filesystem::path& report) {
  namespace fs = std::filesystem;
  std::string scratch = (fs::temp_directory_path() / "idim_browser_XXXXXX").string();
  if (!mkdtemp(scratch.data())) return Status::BadInput("no temporary folder: " + scratch);
  const fs::path dom = fs::path(scratch) / "dom.html";
  const fs::path log = fs::path(scratch) / "log.txt";
  const auto quoted = [](const std::string& text) {
    std::string shell = "'";
    for (const char c : text) shell += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return shell + "'";
  };
  const std::string command = "timeout -k 5 120 " + quoted(chromium) +
                              " --headless --no-sandbox --disable-gpu --disable-quic --no-first-run"
                              " --disable-background-networking --disable-component-update --disable-sync"
                              " --disable-dev-shm-usage --window-size=1400,1000 --virtual-time-budget=60000"
                              " --enable-logging=stderr --user-data-dir=" +
                              quoted(scratch + "/profile") + " --dump-dom " +
                              quoted("file://" + fs::absolute(report).string() + "#check") + " > " +
                              quoted(dom.string()) + " 2> " + quoted(log.string());
  const int exit_status = std::system(command.c_str());
  const std::string page = ReadWholeFile(dom);
  const std::string messages = ReadWholeFile(log);
  std::error_code ignored;
  fs::remove_all(scratch, ignored);
  if (exit_status != 0) {
    return Status::BadInput(chromium + " ended with status " + std::to_string(WEXITSTATUS(exit_status)) + ":\n" +
                            messages);
  }

  const std::size_t open = page.find("<html");
  const std::size_t close = page.find('>', open);
  if (open == std::string::npos || close == std::string::npos)
    return Status::BadInput("no <html> in " + report.string());
  const std::string html_tag = page.substr(open, close - open);
  const auto number = [&html_tag](const std::string& attribute) {
    const std::size_t at = html_tag.find(attribute + "=\"");
    return at == std::string::npos ? -1 : std::atoi(html_tag.c_str() + at + attribute.size() + 2);
  };
  DrawnReport drawn;
  drawn.figures_expected = number("data-figures-expected");
  drawn.figures_drawn = number("data-figures-drawn");
  drawn.script_errors = number("data-script-errors");
  const std::string figure = "<div class=\"figure";
  for (std::size_t at = page.find(figure); at != std::string::npos; at = page.find(figure, at + 1)) {
    const std::string tag = page.substr(at, page.find('>', at) - at);
    drawn.figure_drawn.push_back(tag.find("data-drawn=\"true\"") != std::string::npos);
  }
  return drawn;
}

}  // namespace idim::testing

#endif  // IDIM_TESTS_SUPPORT_BROWSER_H_
