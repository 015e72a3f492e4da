// Mock-up of a subsea well: a block with a different relief on each side.
//
// Object frame: origin in the middle of the footprint on the floor, x along the length, y along the width, z
// up. The mesh is a union of closed solids, some of which penetrate each other, so a ray from outside always
// hits an outside. Nothing extends beyond the nominal size. One material.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/types/scene.h"
#include "core/types/words.h"

namespace sonarcal::sim {

// Sizes of tank and mock-ups that go together.
enum class SizeVariant { kStandard, kAlternative };

constexpr auto WordsOf(std::type_identity<SizeVariant>) {
  return Words<SizeVariant, 2>{
      {{"standard", SizeVariant::kStandard}, {"alternative", SizeVariant::kAlternative}}};
}

enum class MockupPattern {
  kCross,  // a square rim around a raised upright cross
  kPipes,  // five vertical pipes
  kPorts,  // a flange with a stub in its middle, four small ports around it
  kRibs,   // horizontal ribs
};
constexpr auto WordsOf(std::type_identity<MockupPattern>) {
  return Words<MockupPattern, 4>{{{"cross", MockupPattern::kCross},
                                  {"pipes", MockupPattern::kPipes},
                                  {"ports", MockupPattern::kPorts},
                                  {"ribs", MockupPattern::kRibs}}};
}

inline constexpr std::array<MockupPattern, 4> kMockupPatterns = {MockupPattern::kCross, MockupPattern::kPipes,
                                                                 MockupPattern::kPorts, MockupPattern::kRibs};

struct MockupOptions {
  double length_m = 1.0;  // along x
  double width_m = 1.0;   // along y
  double height_m = 1.5;
  double relief_m = 0.08;                                   // depth of the core behind the nominal faces
  std::array<MockupPattern, 4> patterns = kMockupPatterns;  // sides facing -y, +x, +y, -x
  double max_edge_m = 0.25;                                 // longest side of the mesh's quadrilaterals
  std::string material = "mockup";

  // Throws DataError that names the field, its value and the limit.
  void Validate() const;
};

// Standard 1 x 1 x 1.5 m (the default), alternative a cube of 1 m.
MockupOptions MockupOfSize(SizeVariant size);

Scene MakeMockup(const MockupOptions& options = {});

inline constexpr int kMaxMockupTriangles = 5'000'000;

// Options with max_edge_m such that MakeMockup makes at least `triangles` triangles. The mesh is divided in
// whole pieces, so there are usually up to half as many more. Throws DataError above kMaxMockupTriangles.
MockupOptions RefinedTo(MockupOptions options, int triangles);

}  // namespace sonarcal::sim
