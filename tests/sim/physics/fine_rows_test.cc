#include "sim/physics/fine_rows.h"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

namespace sonarcal::sim {
namespace {

// 20 rows of 0.05 m from 1 m on.
FineRows Rows() {
  return {PolarAxes{.range_min_m = 1.0, .range_max_m = 2.0, .range_bins = 10, .beam_azimuth_rad = {}}, 2, 0.1};
}

class RowPower {
 public:
  void Share(double range_m, double power) { Rows().Share(range_m, power, take_); }
  void Spread(double range_m, double depth_m, double power) { Rows().Spread(range_m, depth_m, power, take_); }
  void ExpectEqual(const RowPower& other) const {
    for (std::size_t row = 0; row < power_.size(); ++row)
      EXPECT_NEAR(power_[row], other.power_[row], 1e-12) << row;
  }
  const std::vector<double>& power() const { return power_; }

 private:
  std::vector<double> power_ = std::vector<double>(20, 0.0);
  std::function<void(int, double)> take_ = [this](int row, double power) { power_.at(row) += power; };
};

TEST(FineRowsTest, AnEchoIsSharedByTheTwoNearestRows) {
  RowPower rows;
  rows.Share(1.025 + 3.25 * 0.05, 8.0);
  EXPECT_NEAR(rows.power()[3], 6.0, 1e-9);
  EXPECT_NEAR(rows.power()[4], 2.0, 1e-9);
  RowPower ends;  // half of each lies beyond the rows
  ends.Share(1.0, 8.0);
  ends.Share(2.0, 4.0);
  EXPECT_NEAR(ends.power().front(), 4.0, 1e-9);
  EXPECT_NEAR(ends.power().back(), 2.0, 1e-9);
  RowPower outside;
  outside.Share(0.9, 1.0);
  outside.Share(2.1, 1.0);
  for (const double power : outside.power()) EXPECT_EQ(power, 0.0);
}

// Four parts at even steps of 0.07 m.
TEST(FineRowsTest, APatchIsSpreadOverItsDepth) {
  RowPower spread;
  spread.Spread(1.5, 0.28, 8.0);
  RowPower parts;
  for (const double range_m : {1.395, 1.465, 1.535, 1.605}) parts.Share(range_m, 2.0);
  spread.ExpectEqual(parts);
}

TEST(FineRowsTest, PartsBeyondEitherEndAreReflectedThere) {
  RowPower near;
  near.Spread(1.02, 0.28, 8.0);  // 0.915, 0.985, 1.055 and 1.125 m
  RowPower near_parts;
  for (const double range_m : {1.085, 1.015, 1.055, 1.125}) near_parts.Share(range_m, 2.0);
  near.ExpectEqual(near_parts);
  RowPower far;
  far.Spread(1.98, 0.28, 8.0);  // 1.875, 1.945, 2.015 and 2.085 m
  RowPower far_parts;
  for (const double range_m : {1.875, 1.945, 1.985, 1.915}) far_parts.Share(range_m, 2.0);
  far.ExpectEqual(far_parts);
}

// A part alone stays where it is, beyond the end or not.
TEST(FineRowsTest, APatchOfOnePartIsNotReflected) {
  RowPower spread;
  spread.Spread(0.99, 0.05, 8.0);
  RowPower part;
  part.Share(0.99, 8.0);
  spread.ExpectEqual(part);
}

}  // namespace
}  // namespace sonarcal::sim
