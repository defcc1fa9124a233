# awk -v results=DIR -f scripts/count_cases.awk JUNIT: prints "PASSED FAILED SKIPPED".
#
# JUNIT is what ctest wrote. A ctest of GoogleTest cases counts as these, by the DIR/<its name>.xml that GoogleTest
# wrote; any other counts as one, and so does one that ended before it could write: that has failed.
function attribute(line, name) {
  return match(line, " " name "=\"[^\"]*\"") ? substr(line, RSTART + length(name) + 3, RLENGTH - length(name) - 4) : ""
}
# Adds the cases of one ctest; returns how many there are, 0 without a file.
function add_cases(file, ok,    line, tests, failures, skips) {
  while ((getline line < file) > 0) {
    if (line ~ /<testsuites /) {
      tests = attribute(line, "tests") + 0
      failures = attribute(line, "failures") + attribute(line, "errors")
    }
    if (line ~ /<testcase .*(result="(skipped|suppressed)"|status="notrun")/) skips++
  }
  close(file)
  # All its cases passed and it failed all the same: a leak found at its end, say.
  if (tests > 0 && !ok && failures == 0) failures = 1
  passed += tests - failures - skips
  failed += failures
  skipped += skips
  return tests
}
/<testcase / {
  status = attribute($0, "status")
  if (status == "run" || status == "fail") {
    cases = add_cases(results "/" attribute($0, "name") ".xml", status == "run")
    if (cases == 0 && status == "run") passed++
    if (cases == 0 && status == "fail") failed++
  } else {
    skipped++
  }
}
END { print passed + 0, failed + 0, skipped + 0 }
