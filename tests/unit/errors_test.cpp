#include "impinge/core/errors.hpp"

#include <gtest/gtest.h>

#include "impinge/cases/case.hpp"

namespace impinge {
namespace {

TEST(Errors, DoNotSteerTheTerminal) {
  EXPECT_EQ(printable("a\tb\nc \xc3\xa9\xe2\x82\xac \\"), "a\tb\nc \xc3\xa9\xe2\x82\xac \\");
  EXPECT_EQ(printable(std::string("\x1b[2J\x07\x7f\r\0", 8)), "\\u001b[2J\\u0007\\u007f\\u000d\\u0000");
  EXPECT_EQ(printable("\xc2\x9b"
                      "1m\xc2\xa0\xc2"),
            "\\u009b1m\xc2\xa0\xc2");
  EXPECT_STREQ(FileError("cannot read \x1b").what(), "cannot read \\u001b");
  const InputError error({"a\x1b", "b"});
  EXPECT_STREQ(error.what(), "a\\u001b\nb");
  EXPECT_EQ(error.mistakes(), (std::vector<std::string>{"a\\u001b", "b"}));
}

TEST(Errors, KeysOfACaseFileAreQuotedSafely) {
  try {
    parse_case({{"case.toml", "\"\\u001b[31mkey\" = 1\n"}});
    FAIL();
  } catch (const InputError& mistakes) {
    EXPECT_TRUE(mistakes.mistakes().front().starts_with("case.toml:1: \\u001b[31mkey = 1: unknown key"))
        << mistakes.what();
  }
}

}  // namespace
}  // namespace impinge
