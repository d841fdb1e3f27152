#include "pipeline/report_text.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "pipeline/report_rows.hpp"

namespace seampath {
namespace report_text_test {

TEST(ReportText, RoundsForPeople) {
    EXPECT_EQ(decimal(0.0125, 3), "0.013");  // the double is above 0.0125
    EXPECT_EQ(decimal(-0.0004, 3), "0.000");
    EXPECT_EQ(decimal(-0.0006, 3), "-0.001");
    EXPECT_EQ(decimal(1e300, 1).size(), 303U);
    EXPECT_EQ(decimal(std::nan(""), 3), "–");
    EXPECT_EQ(decimal(-std::numeric_limits<double>::infinity(), 3), "–");
}

TEST(ReportText, GroupsDigits) {
    EXPECT_EQ(grouped(0), "0");
    EXPECT_EQ(grouped(999), "999");
    EXPECT_EQ(grouped(1284331), "1\u202f284\u202f331");
    EXPECT_EQ(grouped(-100000), "-100\u202f000");
}

TEST(ReportText, EscapesWhatCouldLeaveTextOrAttribute) {
    EXPECT_EQ(escape_html("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
}

// Overlong forms, surrogates and values above U+10FFFF (RFC 3629) are no UTF-8.
TEST(ReportText, RepairsUtf8) {
    EXPECT_EQ(valid_utf8("Rohr ø 60 · 10 €, \U0001F600"), "Rohr ø 60 · 10 €, \U0001F600");
    EXPECT_EQ(valid_utf8("a\xff"
                         "b"),
              "a\uFFFDb");
    EXPECT_EQ(valid_utf8("\xc0\xaf"), "\uFFFD\uFFFD");
    EXPECT_EQ(valid_utf8("\xed\xa0\x80"), "\uFFFD\uFFFD\uFFFD");
    EXPECT_EQ(valid_utf8("\xf4\x90\x80\x80"), "\uFFFD\uFFFD\uFFFD\uFFFD");
    EXPECT_EQ(valid_utf8("cut \xe2\x82"), "cut \uFFFD\uFFFD");
}

// RFC 4648, section 10.
TEST(ReportText, EncodesBase64) {
    EXPECT_EQ(base64(""), "");
    EXPECT_EQ(base64("f"), "Zg==");
    EXPECT_EQ(base64("fo"), "Zm8=");
    EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

TEST(ReportText, ShowsValues) {
    EXPECT_EQ(shown({"a", "", 0.00004, "mm", "", 3}), "<0.001");
    EXPECT_EQ(shown({"a", "", -0.0006, "mm", "", 3}), "-0.001");
    EXPECT_EQ(shown({"a", "", 0.0, "mm", "", 3}), "0.000");
    EXPECT_EQ(shown({"a", "", std::int64_t{12345}, "", "", 0}), "12\u202f345");
    EXPECT_EQ(shown({"a", "", true, "", "", 0}), "yes");
    EXPECT_EQ(exact({"a", "", 0.1, "mm", "", 3}), "0.1");
    EXPECT_EQ(exact({"a", "", std::nan(""), "mm", "", 3}), "null");
    EXPECT_EQ(exact({"a", "", std::string("x<y"), "", "", 0}), "x<y");
}

}  // namespace report_text_test
}  // namespace seampath
