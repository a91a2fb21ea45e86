#include <cstdio>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

namespace {

int exit_code(const std::string& arguments) {
  return WEXITSTATUS(std::system((std::string(ARETE_TOOL) + " " + arguments + " > /dev/null 2>&1").c_str()));
}

TEST(Command, HelpAndVersionSucceed) {
  EXPECT_EQ(exit_code("--help"), 0);
  EXPECT_EQ(exit_code("--version"), 0);
}

TEST(Command, AnUnknownVerbOrNoneIsAUsageError) {
  EXPECT_EQ(exit_code("transmogrify"), 2);
  EXPECT_EQ(exit_code(""), 2);
}

}  // namespace
