// What a new user types: help, misspelt words, --verbose, --log and --options.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/commands/examples.h"
#include "tests/apps/run_program.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::cli {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::Outcome;
using testing::Quoted;
using testing::ReadFile;
using testing::RunSonarcal;
using testing::WriteFile;

// Scenes of the program, small enough for a test.
std::string Scenes(const std::filesystem::path& out) {
  return "scenes --only tank --edge 2 --out " + Quoted(out);
}

// Every line of a log begins with a time.
void ExpectTimes(const std::string& log) {
  std::istringstream stream(log);
  static const std::regex kTimed(R"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d[+-]\d{4} .+)");
  for (std::string line; std::getline(stream, line);) EXPECT_TRUE(std::regex_match(line, kTimed)) << line;
}

TEST(HelpTest, CommandsAreGroupedWithOneLineEachAndExamplesAtTheEnd) {
  const std::string help = RunSonarcal("--help").out;
  std::size_t last = 0;
  for (const char* heading :
       {"\nStart here:\n  scenes ", "\nCalibrate:\n  calibrate ", "\nLook at data:\n  inspect ",
        "\nExchange and automate:\n  convert ", "\nExamples, one after the other:\n  sonarcal scenes "}) {
    const std::size_t found = help.find(heading);
    ASSERT_NE(found, std::string::npos) << heading;
    EXPECT_GT(found, last) << heading;
    last = found;
  }
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100U) << line;
}

TEST(HelpTest, TheCommandHelpIsTheOptionHelp) {
  EXPECT_EQ(RunSonarcal("help").out, RunSonarcal("--help").out);
  EXPECT_EQ(RunSonarcal("help fit").out, RunSonarcal("fit --help").out);
  const Outcome unknown = RunSonarcal("help fti");
  EXPECT_EQ(unknown.status, 2);
  EXPECT_EQ(unknown.err, "sonarcal: unknown command 'fti', did you mean 'fit'?\n");
}

TEST(HelpTest, EachCommandHasGroupsAndAnExample) {
  for (const commands::Example& example : commands::Examples()) {
    const std::string help = RunSonarcal(example.command + " --help").out;
    EXPECT_THAT(help, AllOf(HasSubstr("\nEvery command:\n  -h, --help "), HasSubstr("\nExample"),
                            HasSubstr("sonarcal " + example.command)));
  }
  const std::string fit = RunSonarcal("fit --help").out;
  EXPECT_LT(fit.find("\nInput:\n"), fit.find("\nOutput:\n"));
  EXPECT_LT(fit.find("\nRays:\n"), fit.find("\nSegmentation and comparison:\n"));
}

// Runs the examples in one folder, each line once. Those that need minutes or a user's files are parsed by
// their --help only.
TEST(HelpTest, TheExamplesWork) {
  const testing::TempDir dir;
  std::set<std::string> done;
  for (const commands::Example& example : commands::Examples()) {
    if (example.needs != commands::Needs::kNothing) continue;
    for (const std::string& line : example.lines) {
      if (!done.insert(line).second) continue;
      const Outcome outcome =
          testing::RunSonarcalIn(dir.path(), line.substr(std::string("sonarcal ").size()));
      EXPECT_EQ(outcome.status, 0) << line << '\n' << outcome.err;
    }
  }
}

TEST(HelpTest, TheExamplesThatNeedFilesHaveKnownOptions) {
  static const std::regex kOption("--[a-z-]+");
  for (const commands::Example& example : commands::Examples()) {
    for (const std::string& line : example.lines) {
      const std::string command = line.substr(9, line.find(' ', 9) - 9);
      const std::string help = RunSonarcal(command + " --help").out;
      for (std::sregex_iterator match(line.begin(), line.end(), kOption), end; match != end; ++match)
        EXPECT_THAT(help, HasSubstr(match->str() + ' ')) << line;
    }
  }
}

TEST(SuggestionTest, AMisspeltWordGetsTheNearestOne) {
  for (const auto& [arguments, expected] : std::vector<std::pair<std::string, std::string>>{
           {"fti", "unknown command 'fti', did you mean 'fit'? (see 'sonarcal --help')"},
           {"simulate --scnee x", "unknown option '--scnee', did you mean '--scene'? (see"},
           {"simulate --rasy=3x3", "unknown option '--rasy', did you mean '--rays'?"},
           {"gallery --out x --sampling beans", "'beans', expected frustum|beams; did you mean 'beams'?"},
           {"export --to stonefsh", "'stonefsh', did you mean 'stonefish'?"},
           {"gallery --out x --sonar p900", "unknown sonar 'p900', did you mean 'p900-45'?"},
           {"scenes --out x --only jackt", "; did you mean 'jacket'?"}}) {
    const Outcome outcome = RunSonarcal(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_THAT(outcome.err, HasSubstr(expected)) << arguments;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
}

TEST(SuggestionTest, AWordThatIsNearNothingGetsTheList) {
  EXPECT_THAT(RunSonarcal("frobnicate").err,
              HasSubstr("unknown command 'frobnicate', expected one of scenes, "));
  EXPECT_THAT(RunSonarcal("inspect --frobnicate x").err,
              HasSubstr("unknown option '--frobnicate' (see 'sonarcal inspect --help')"));
}

TEST(MessagesTest, VerbosePrintsOptionsAndFilesAndTheEnd) {
  const testing::TempDir dir;
  const Outcome plain = RunSonarcal(Scenes(dir / "plain"));
  EXPECT_THAT(plain.err, Not(HasSubstr("wrote")));
  const Outcome verbose = RunSonarcal(Scenes(dir / "verbose") + " --verbose");
  EXPECT_EQ(verbose.status, 0);
  EXPECT_EQ(RunSonarcal(Scenes(dir / "again") + " -v").status, 0);
  EXPECT_THAT(verbose.err, AllOf(::testing::ContainsRegex("sonarcal: \\[ +[0-9.]+ s\\] version "),
                                 HasSubstr("--edge = 2 (command line)"), HasSubstr("verbose/tank.gltf ("),
                                 HasSubstr("ended with status 0 after ")));
}

TEST(MessagesTest, TheLogHasAllMessagesWithTimesAndGrows) {
  const testing::TempDir dir;
  const std::string with_log = " --quiet --log " + Quoted(dir / "run.log");
  const Outcome outcome = RunSonarcal(Scenes(dir / "tank") + with_log);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, IsEmpty());
  const std::string log = ReadFile(dir / "run.log");
  EXPECT_THAT(log, AllOf(HasSubstr("--edge = 2 (command line)"), HasSubstr("wrote "), HasSubstr("status 0")));
  ExpectTimes(log);

  const Outcome failed = RunSonarcal("inspect /nowhere" + with_log);
  EXPECT_EQ(failed.status, 1);
  const std::string longer = ReadFile(dir / "run.log");
  EXPECT_TRUE(longer.starts_with(log));
  EXPECT_THAT(longer, AllOf(HasSubstr(" error: "), HasSubstr("/nowhere"), HasSubstr("status 1")));
  ExpectTimes(longer);
}

TEST(MessagesTest, TheLogOfAnInterruptedRunSaysSo) {
  const testing::TempDir dir;
  const std::filesystem::path log = dir / "run.log";
  // `gallery` ends at once when it is interrupted; so many rays take longer than the wait.
  const std::string script = fmt::format(
      "'{}' gallery --only tank --rays 6000x6000 --quiet --out '{}' --log '{}' & "
      "for i in $(seq 300); do grep -q version '{}' 2>/dev/null && break; sleep 0.1; done; "
      "kill -TERM $!; wait $!",
      SONARCAL_BINARY, (dir / "out").string(), log.string(), log.string());
  const int status = std::system(("( " + script + " ) 2>/dev/null").c_str());
  EXPECT_NE(status, 0);
  const std::string text = ReadFile(log);
  EXPECT_THAT(text, EndsWith("error: interrupted, unfinished outputs were removed\n"));
  ExpectTimes(text);
}

TEST(MessagesTest, OptionsThatContradictEachOtherAreRefused) {
  const testing::TempDir dir;
  const auto error = [](const std::string& arguments) {
    const Outcome outcome = RunSonarcal(arguments);
    EXPECT_NE(outcome.status, 0) << arguments;
    return outcome.err;
  };
  EXPECT_THAT(error("sonars --quiet --verbose"), HasSubstr("--verbose has no effect with --quiet"));
  EXPECT_THAT(error("sonars --log /nowhere/run.log"), HasSubstr("--log /nowhere/run.log: cannot be written"));
  EXPECT_THAT(error(Scenes(dir / "out") + " --log " + Quoted(dir / "out" / "run.log")),
              HasSubstr("run.log is inside --out, expected a file outside"));
  EXPECT_FALSE(std::filesystem::exists(dir / "out"));
}

TEST(MessagesTest, NoLogReplacesAFileOfTheUser) {
  const testing::TempDir dir;
  WriteFile(dir / "params.json", "{}");
  const Outcome outcome = RunSonarcal("sonars --quiet --log " + Quoted(dir / "params.json"));
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("is a file without messages"));
  EXPECT_EQ(ReadFile(dir / "params.json"), "{}");
}

TEST(MessagesTest, APipeThatNobodyReadsIsNoLog) {
  const testing::TempDir dir;
  ASSERT_EQ(mkfifo((dir / "pipe").c_str(), 0600), 0);
  const Outcome outcome = RunSonarcal("sonars --quiet --log " + Quoted(dir / "pipe"));
  EXPECT_EQ(outcome.status, 2);
  EXPECT_THAT(outcome.err, HasSubstr("a pipe that nobody reads"));
}

// The program waits for room in a pipe that nobody reads: a signal must end it nevertheless.
TEST(MessagesTest, ASignalEndsAProgramWhoseOutputNobodyReads) {
  std::array<int, 2> results{};
  ASSERT_EQ(pipe(results.data()), 0);
  ASSERT_GT(fcntl(results[1], F_SETPIPE_SZ, 4096), 0);
  const pid_t process = fork();
  if (process == 0) {
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) std::signal(number, SIG_DFL);
    dup2(results[1], STDOUT_FILENO);
    execl(SONARCAL_BINARY, "sonarcal", "sonars", "--json", nullptr);
    _exit(127);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  int status = 0;
  ASSERT_EQ(waitpid(process, &status, WNOHANG), 0) << "the text fits into the pipe";
  kill(process, SIGTERM);
  pid_t ended = 0;
  for (int i = 0; i < 100 && ended == 0; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    ended = waitpid(process, &status, WNOHANG);
  }
  if (ended == 0) {
    kill(process, SIGKILL);
    waitpid(process, &status, 0);
  }
  close(results[0]);
  close(results[1]);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGTERM);
}

// `sonarcal ... | head`: the signal of the pipe must not leave unfinished outputs behind.
TEST(MessagesTest, APipeWithoutAReaderLeavesNoUnfinishedOutputs) {
  const testing::TempDir dir;
  std::array<int, 2> messages{};
  ASSERT_EQ(pipe(messages.data()), 0);
  close(messages[0]);
  const pid_t process = fork();
  if (process == 0) {
    std::signal(SIGPIPE, SIG_DFL);
    dup2(messages[1], STDERR_FILENO);
    execl(SONARCAL_BINARY, "sonarcal", "reproduce", "--quick", "--out", (dir / "out").c_str(), nullptr);
    _exit(127);
  }
  close(messages[1]);
  int status = 0;
  waitpid(process, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status)) << WEXITSTATUS(status);
  EXPECT_EQ(WTERMSIG(status), SIGPIPE);
  EXPECT_TRUE(std::filesystem::is_empty(dir.path()));
}

TEST(MessagesTest, AnOptionIsNoValueOfAnother) {
  const testing::TempDir dir;
  for (const char* words : {"--only --surface", "--only=", "--log= --surface"}) {
    const Outcome outcome = RunSonarcal(Scenes(dir / "out") + " " + words);
    EXPECT_EQ(outcome.status, 2) << words;
    EXPECT_THAT(outcome.err, HasSubstr("value")) << words;
    EXPECT_FALSE(std::filesystem::exists(dir / "out"));
  }
}

TEST(OptionsFileTest, OptionsComeFromTheFileAndTheCommandLineWins) {
  const testing::TempDir dir;
  WriteFile(dir / "scenes.toml",
            "\xEF\xBB\xBF# a test, behind a byte order mark\nonly = [\"tank\", \"jacket\"]\n"
            "edge = 2\nsurface = true\nbed = false\n"
            "out = \"/nowhere/at/all\"\nseed = 3\n");
  const Outcome outcome = RunSonarcal("scenes --options " + Quoted(dir / "scenes.toml") + " --seed 4 --out " +
                                      Quoted(dir / "paper"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(dir / "paper" / "jacket.gltf"));
  const auto provenance = nlohmann::json::parse(ReadFile(dir / "paper" / "provenance.json"));
  EXPECT_EQ(provenance.at("seed"), 4);
  EXPECT_EQ(provenance.at("inputs").back().at("path"), (dir / "scenes.toml").string());
}

TEST(OptionsFileTest, MistakesAreNamed) {
  const testing::TempDir dir;
  const auto refusal = [&](const std::string& text) {
    WriteFile(dir / "o.toml", text);
    const Outcome outcome = RunSonarcal("scenes --options=" + Quoted(dir / "o.toml"));
    EXPECT_EQ(outcome.status, 1) << text;
    return outcome.err;
  };
  EXPECT_THAT(refusal("seeed = 3\n"),
              HasSubstr("o.toml: unknown option 'seeed' of sonarcal scenes, did you mean 'seed'?"));
  EXPECT_THAT(refusal("options = \"x\"\n"), HasSubstr("unknown option 'options'"));
  EXPECT_THAT(refusal("only = \"\"\n"), HasSubstr("only has no value"));
  EXPECT_THAT(refusal("surface = 3\n"), HasSubstr("surface is '3', expected true or false"));
  EXPECT_THAT(refusal("[scenes]\nseed = 3\n"), HasSubstr("has the section [scenes]"));
  EXPECT_THAT(RunSonarcal("scenes --options /nowhere").err, HasSubstr("/nowhere: no such file"));
}

}  // namespace
}  // namespace sonarcal::cli
