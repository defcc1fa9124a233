#include "core/base/text.h"

#include <gtest/gtest.h>

namespace idim::text_test {
namespace {

TEST(ParseNumber, TakesWholeFiniteNumbersOnly) {
  double value = -1.0;
  EXPECT_EQ(ParseNumber("-1.25e-3", &value), NumberText::kOk);
  EXPECT_EQ(value, -1.25e-3);
  EXPECT_EQ(ParseNumber("+7", &value), NumberText::kOk);
  EXPECT_EQ(value, 7.0);
  for (const char* text : {"", "+", "abc", "1.0x", "1 ", " 1", "0x10", "1,5", "+-1", "--1", "1_000"}) {
    EXPECT_EQ(ParseNumber(text, &value), NumberText::kNotANumber) << text;
  }
  for (const char* text : {"nan", "NaN", "inf", "-inf", "Infinity"}) {
    EXPECT_EQ(ParseNumber(text, &value), NumberText::kNotFinite) << text;
  }
  for (const char* text : {"1e300", "-1.1e12", "1e999"}) {
    EXPECT_EQ(ParseNumber(text, &value), NumberText::kTooLarge) << text;
  }
  EXPECT_EQ(ParseNumber("1e12", &value), NumberText::kOk);
}

TEST(FormatNumber, ReadsBackToTheSameDouble) {
  for (const double x : {0.1, 1.0 / 3.0, 1e-300, 838.4650, -0.0}) {
    EXPECT_EQ(std::stod(FormatNumber(x)), x);
  }
  EXPECT_EQ(FormatNumber(0.1), "0.1");
}

TEST(NearestName, ByEditDistance) {
  const std::vector<std::string> names = {"gravity", "joints", "transmission"};
  EXPECT_EQ(NearestName("gravty", names), "gravity");
  EXPECT_EQ(NearestName("joint", names), "joints");
  EXPECT_EQ(NearestName("transmision", names), "transmission");
  EXPECT_EQ(NearestName("x", {}), "");
}

TEST(Clip, LongAndUnprintable) {
  EXPECT_EQ(Clip("a\nb"), "a?b");
  EXPECT_EQ(Clip(std::string(50, 'x')), std::string(40, 'x') + "...");
}

TEST(Format, IsPrintfOfAnyLength) {
  EXPECT_EQ(Format("%d %s %.2f", 3, "x", 1.005), "3 x 1.00");
  const std::string longer(2000, 'a');
  EXPECT_EQ(Format("<%s>", longer.c_str()), "<" + longer + ">");
  EXPECT_EQ(Format("%s", ""), "");
}

// A sigma takes two bytes and one column; no blanks at the ends of lines; rows may be short.
TEST(AlignColumns, FirstToTheLeftOthersToTheRight) {
  EXPECT_EQ(AlignColumns({{"a", "\xcf\x83", "value"}, {"long", "12", ""}, {"b"}, {"c", "", "3"}}),
            "a      \xcf\x83  value\n"
            "long  12\n"
            "b\n"
            "c             3\n");
  EXPECT_EQ(AlignColumns({}), "");
}

}  // namespace
}  // namespace idim::text_test
