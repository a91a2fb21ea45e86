#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

struct Outcome {
  int code = -1;
  std::string out, err;
};

std::string slurp(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

Outcome run(const std::string& arguments) {
  const std::string base = testing::TempDir() + "/arete-command-" + std::to_string(getpid());
  const int status = std::system((std::string(ARETE_TOOL) + " " + arguments + " > " + base + ".out 2> " + base + ".err").c_str());
  return {WEXITSTATUS(status), slurp(base + ".out"), slurp(base + ".err")};
}

void expect_one_line(const std::string& text) {
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
  EXPECT_EQ(text.back(), '\n');
}

TEST(Command, HelpAndVersionSucceed) {
  EXPECT_THAT(run("--help").out, HasSubstr("completion"));
  EXPECT_EQ(run("--version").out, "arete " ARETE_VERSION "\n");
  EXPECT_EQ(run("completion --help").code, 0);
}

TEST(Command, AMistakeIsOneLineThatNamesItAndTellsHowToGetHelp) {
  for (const char* arguments : {"transmogrify", "", "--transmogrify", "completion csh", "completion", "completion bash --nonsense"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, 2) << arguments;
    EXPECT_EQ(outcome.out, "");
    expect_one_line(outcome.err);
    EXPECT_THAT(outcome.err, StartsWith("arete"));
    EXPECT_THAT(outcome.err, HasSubstr("--help'"));
  }
  EXPECT_THAT(run("transmogrify").err, HasSubstr("unknown verb 'transmogrify'"));
  EXPECT_THAT(run("completion bash --nonsense").err, HasSubstr("--nonsense"));
  EXPECT_THAT(run("completion csh").err, HasSubstr("csh"));
}

TEST(Command, AFullDiskIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full";
  const int status = std::system((std::string(ARETE_TOOL) + " completion bash > /dev/full 2> /dev/null").c_str());
  EXPECT_EQ(WEXITSTATUS(status), 5);
}

TEST(Completion, ScriptsOfferTheVerbs) {
  for (const char* shell : {"bash", "zsh", "fish"}) {
    const Outcome outcome = run(std::string("completion ") + shell);
    EXPECT_EQ(outcome.code, 0);
    EXPECT_THAT(outcome.out, HasSubstr("completion"));
  }
}

TEST(Completion, BashReadsItsScript) {
  EXPECT_EQ(std::system((std::string(ARETE_TOOL) + " completion bash | bash -n").c_str()), 0);
}

TEST(Manual, HasAPageForTheCommandAndForAVerb) {
  EXPECT_THAT(run("man").out, StartsWith(".TH ARETE 1"));
  EXPECT_THAT(run("man").out, HasSubstr(".SH EXIT STATUS"));
  EXPECT_THAT(run("man completion").out, HasSubstr("arete\\-completion"));
  EXPECT_EQ(run("man transmogrify").code, 2);
  EXPECT_THAT(run("--help").out, Not(HasSubstr("\n  man ")));
}

TEST(Help, SaysWhatAnOptionTakesInPlainWords) {
  for (const char* verb : {"learn", "amplify", "compare", "preview", "info", "demo", "completion"}) {
    const std::string help = run(std::string(verb) + " --help").out;
    for (const char* jargon : {"INT", "FLOAT", "TEXT", "in [", "POSITIVE", "(1x)", "{"}) EXPECT_THAT(help, Not(HasSubstr(jargon))) << verb;
    EXPECT_THAT(help, HasSubstr("Example:")) << verb;
    EXPECT_THAT(run(std::string("man ") + verb).out, Not(HasSubstr("INT"))) << verb;
  }
  EXPECT_THAT(run("amplify --help").out, HasSubstr("--method consistent|paper"));
  EXPECT_THAT(run("amplify --help").out, HasSubstr("--detail 0..1"));
}

}  // namespace
