// Numbers on other processors: the program under other instruction sets, beside the program as it is.
// Without AVX2 and FMA, arithmetic of rows, the maths library and the ray tracer run other code. An emulator
// runs the whole program on a processor that has neither. It also runs it on a processor that has both, but
// whose estimates of reciprocals and roots have other bits, as those of another maker have. What this machine
// cannot run is skipped.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ostream>
#include <string>
#include <vector>

#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "tests/apps/run_program.h"
#include "tests/apps/tiny_world.h"

namespace sonarcal::testing {
namespace {

// Allowed difference of a pixel, in grey levels of 65,535.
constexpr float kFewLevels = 8.0F;
// Allowed share of pixels that differ by more.
constexpr double kMaxShareApart = 1e-3;

struct Processor {
  const char* name;
  const char* prefix;  // words before the command
  bool same_bits;      // it has AVX2 and FMA, so images must have the same bits

  friend std::ostream& operator<<(std::ostream& out, const Processor& processor) {
    return out << processor.name;
  }
};

// True if this processor has the parts of AVX-512 that Embree's kernels need.
bool HasAvx512() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512cd") &&
         __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512vl");
#else
  return false;
#endif
}

bool HasAvx2AndFma() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
  return false;
#endif
}

// Returns why a processor cannot be compared with this one; empty if it can.
std::string WhyNot(const Processor& processor) {
  const std::string prefix = processor.prefix;
  if (processor.same_bits && !HasAvx2AndFma()) return "this processor lacks AVX2 or FMA";
  if (prefix.starts_with("qemu")) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    return "a sanitizer reserves terabytes of memory, and qemu-x86_64 fills them";
#endif
    if (std::system("command -v qemu-x86_64 >/dev/null") != 0) return "no qemu-x86_64";
  }
  if (prefix.ends_with("avx512") && !HasAvx512()) return "this processor has no AVX-512";
  return {};
}

class OtherProcessor : public ::testing::TestWithParam<Processor> {
 protected:
  void SetUp() override {
    if (const std::string reason = WhyNot(GetParam()); !reason.empty()) GTEST_SKIP() << reason;
  }
  static std::string prefix() { return GetParam().prefix; }

  static void Run(const std::string& prefix, const std::string& arguments) {
    const Outcome outcome = RunSonarcal(arguments, prefix);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
  }

  TinyWorld world_;
};

// Share of pixels that differ by more than `levels` grey levels.
double ShareApart(const Grid<float>& one, const Grid<float>& other, float levels) {
  double apart = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i)
    apart += std::abs(one.values()[i] - other.values()[i]) > levels ? 1.0 : 0.0;
  return apart / static_cast<double>(one.size());
}

TEST_P(OtherProcessor, ImagesAreEqual) {
  struct Image {
    ParameterSet parameters;
    const char* option;
  };
  for (const auto& [parameters, option] :
       {Image{TinyParameters(), "--expected"}, Image{TinyParameters(), "--noise"},
        Image{TinyAcousticParameters(), "--expected"}, Image{TinyAcousticParameters(), "--noise"},
        Image{TinyAcousticParameters(), "--model coherent"}}) {
    SCOPED_TRACE(std::string(parameters.model == EchoModel::kPaper ? "paper " : "acoustic ") + option);
    data_io::WriteParameters(world_.params(), parameters);
    const std::string arguments =
        world_.SimulateArguments() + " --bits 16 --force --quiet " + option + " --out ";
    Run("", arguments + Quoted(world_ / "here"));
    Run(prefix(), arguments + Quoted(world_ / "there"));
    const auto here = data_io::OpenRecording(world_ / "here");
    const auto there = data_io::OpenRecording(world_ / "there");
    ASSERT_EQ(here->frame_count(), 4);
    ASSERT_EQ(there->frame_count(), 4);
    for (int frame = 0; frame < 4; ++frame) {
      const Grid<float> one = here->ReadFrame(frame).image.value;
      const Grid<float> other = there->ReadFrame(frame).image.value;
      const auto [darkest, brightest] = std::minmax_element(one.values().begin(), one.values().end());
      ASSERT_GT(*brightest - *darkest, 6000.0F);
      // With other instructions, a ray at an edge, or at the border of a pixel, may fall to either side.
      const bool same_bits = GetParam().same_bits;
      EXPECT_LE(ShareApart(one, other, same_bits ? 0.0F : kFewLevels), same_bits ? 0.0 : kMaxShareApart)
          << frame;
    }
  }
}

// All fits to a recording must end at the same optimum, so no decision may depend on rounding.
TEST_P(OtherProcessor, FitsEndAtTheSameOptimum) {
  for (const ParameterSet& truth : {TinyParameters(), TinyAcousticParameters()}) {
    SCOPED_TRACE(truth.model == EchoModel::kPaper ? "paper" : "acoustic");
    data_io::WriteParameters(world_.params(), truth);
    Run("",
        world_.SimulateArguments() + " --bits 12 --noise --force --quiet --out " + Quoted(world_ / "rec"));
    ParameterSet start = truth;
    for (auto& [name, material] : start.materials) {
      material.gsab.a *= 2.0;
      material.gsab.c *= 0.6;
      material.gsab.b_deg *= 1.3;
    }
    data_io::WriteParameters(world_ / "start.json", start);
    const auto fitted = [&](const std::string& prefix, const std::string& name) {
      Run(prefix, "fit --rays 48x50 --starts 2 --force --quiet --real " + Quoted(world_ / "rec") +
                      " --scene " + Quoted(world_.scene()) + " --params " + Quoted(world_ / "start.json") +
                      " --out " + Quoted(world_ / name));
      return ReadJsonFile(world_ / name / "fit.json");
    };
    const nlohmann::json here = fitted("", "fit_here");
    const nlohmann::json there = fitted(prefix(), "fit_there");
    int compared = 0;
    for (std::size_t i = 0; i < here["parameters"].size(); ++i) {
      const nlohmann::json& one = here["parameters"][i];
      const nlohmann::json& other = there["parameters"][i];
      ASSERT_EQ(one["name"], other["name"]);
      EXPECT_EQ(one["status"], other["status"]) << one["name"];
      if (!one["sigma"].is_number()) continue;
      ++compared;
      const double sigma = one["sigma"];
      const bool same_bits = GetParam().same_bits;
      EXPECT_NEAR(one["value"].get<double>(), other["value"].get<double>(), (same_bits ? 1e-6 : 0.1) * sigma)
          << one["name"];
      EXPECT_NEAR(sigma, other["sigma"].get<double>(), (same_bits ? 1e-6 : 0.05) * sigma) << one["name"];
    }
    EXPECT_GE(compared, 3);
  }
}

TEST(RayTracerKernels, ThoseThatTheProcessorLacksAreRefused) {
  if (HasAvx512()) GTEST_SKIP() << "this processor has AVX-512";
  const TinyWorld world;
  const Outcome outcome = RunSonarcal(world.SimulateArguments() + " --quiet --out " + Quoted(world / "sim"),
                                      "SONARCAL_EMBREE=isa=avx512");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, ::testing::HasSubstr("SONARCAL_EMBREE is 'isa=avx512'"));
}

INSTANTIATE_TEST_SUITE_P(All, OtherProcessor,
                         ::testing::Values(Processor{"TracingByAvx512", "SONARCAL_EMBREE=isa=avx512", false},
                                           Processor{"TracingBySse2", "SONARCAL_EMBREE=isa=sse2", false},
                                           Processor{"MathsWithoutAvx2",
                                                     "GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-AVX512F",
                                                     false},
                                           Processor{"OfAnotherMaker", "qemu-x86_64 -cpu max", true},
                                           Processor{"WithoutAvx2AndFma", "qemu-x86_64 -cpu Nehalem", false}),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace sonarcal::testing
