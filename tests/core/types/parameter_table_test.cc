#include "core/types/parameter_table.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <type_traits>

namespace sonarcal {
namespace {

// Calls visit(info, value) for each number, word and list of a group and of the groups below it.
template <typename Group, typename Visitor>
void VisitAll(const Group& group, const Visitor& visit) {
  VisitParameters(group, [&]<typename Info, typename Member>(const Info& info, const Member& member) {
    if constexpr (std::is_same_v<Info, ParameterInfo>) {
      visit(info, member);
    } else if constexpr (requires { typename Member::mapped_type; }) {
      VisitAll(typename Member::mapped_type(), visit);
    } else if constexpr (requires { member.has_value(); }) {
      VisitAll(typename Member::value_type(), visit);
    } else {
      VisitAll(member, visit);
    }
  });
}

TEST(ParameterTable, DefaultsLieWithinTheLimitsOfTheFile) {
  int numbers = 0;
  VisitAll(ParameterSet(), [&]<typename T>(const ParameterInfo& info, const T& value) {
    if constexpr (std::is_same_v<T, double>) {
      EXPECT_GE(value, info.min) << info.key;
      EXPECT_LE(value, info.max) << info.key;
      EXPECT_FALSE(info.above_min && value == info.min) << info.key;
      ++numbers;
    }
  });
  EXPECT_GE(numbers, 30);
}

TEST(ParameterTable, EachParameterHasAMeaningAndEachNumberAUnit) {
  VisitAll(ParameterSet(), [&]<typename T>(const ParameterInfo& info, const T&) {
    const bool words = HasWords<T> || std::is_same_v<T, std::string>;
    EXPECT_FALSE(info.meaning.empty()) << info.key;
    EXPECT_NE(info.meaning.back(), '.') << info.key;
    EXPECT_EQ(info.unit.empty(), words) << info.key;
  });
}

TEST(ParameterTable, LogarithmicParametersHavePositiveLimits) {
  VisitAll(ParameterSet(), [&](const ParameterInfo& info, const auto&) {
    if (info.scale != ParameterScale::kLogarithmic) return;
    for (const auto& fit : {info.paper_fit, info.acoustic_fit}) {
      EXPECT_TRUE(!fit || fit->lower > 0.0) << info.key;
    }
    EXPECT_TRUE(!info.control || info.control->lower > 0.0) << info.key;
    EXPECT_TRUE(info.paper_fit || info.acoustic_fit || info.control) << info.key;
  });
}

// Limits in units of the sonar become values only with a sonar; parameter_catalog_test.cc checks them.
TEST(ParameterTable, LimitsOfAFitLieWithinTheLimitsOfTheFile) {
  VisitAll(ParameterSet(), [&](const ParameterInfo& info, const auto&) {
    for (const auto& fit : {info.paper_fit, info.acoustic_fit}) {
      if (!fit || fit->unit != LimitUnit::kValue) continue;
      EXPECT_LT(fit->lower, fit->upper) << info.key;
      EXPECT_GE(fit->lower, info.min) << info.key;
      EXPECT_LE(fit->upper, info.max) << info.key;
    }
  });
}

TEST(ParameterTable, OnlyTheModelsThatUseAParameterFitIt) {
  VisitAll(ParameterSet(), [&](const ParameterInfo& info, const auto&) {
    EXPECT_TRUE(info.models.paper || !info.paper_fit) << info.key;
    EXPECT_TRUE(info.models.acoustic || !info.acoustic_fit) << info.key;
  });
}

TEST(ParameterTable, MembersAreFoundByKey) {
  ParameterSet set;
  set.receiver.noise_db = 3.0;
  EXPECT_EQ(&ParameterMember<double>(set.receiver, "noise_db"), &*set.receiver.noise_db);
  EXPECT_EQ(&ParameterMember<double>(set.beam, "transmit_end_deg"), &set.beam.transmit_end_deg);
  GsabParameters<float> curve;
  EXPECT_EQ(&ParameterMember<float>(curve, "F_deg"), &curve.f_deg);
  EXPECT_THROW(ParameterMember<double>(set.beam, "looks"), std::logic_error);
}

}  // namespace
}  // namespace sonarcal
