// Scaled subsea well that Park 2024 (Section 6, Fig. 9) put into a tank: a block "with a unique pattern on
// each side". The paper gives two different sizes, and neither drawings nor the depth of the patterns. The
// reliefs here are assumptions.
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

// Source of the size. The text (Section 6) and Table 5 contradict each other.
enum class PaperSize { kTable5, kText };

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

// 1 x 1 x 1.5 m (Table 5, the default), or the 1 m cube of the text.
MockupOptions MockupOfPaper(PaperSize size);

Scene MakeMockup(const MockupOptions& options = {});

inline constexpr int kMaxMockupTriangles = 5'000'000;

// Options with max_edge_m such that MakeMockup makes at least `triangles` triangles. The mesh is divided in
// whole pieces, so there are usually up to half as many more. Throws DataError above kMaxMockupTriangles.
MockupOptions RefinedTo(MockupOptions options, int triangles);

}  // namespace sonarcal::sim
