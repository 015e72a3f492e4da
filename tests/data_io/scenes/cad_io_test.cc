// Scenes from OBJ, STL and PLY: what is read, and what becomes of units and axes.
#include "data_io/scenes/cad_io.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/scenes/scene_io.h"
#include "tests/data_io/cad_files.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

using Eigen::Vector3d;
using testing::BinaryPly;
using testing::BinaryStl;
using testing::Bounds;
using testing::CubeFacets;
using testing::CubeObj;
using testing::IsClosed;
using testing::SignedVolumeM3;
using testing::TempDir;
using testing::TextPly;
using testing::TextStl;
using testing::WriteFile;

constexpr UpAxis kY = UpAxis::kY;
constexpr UpAxis kZ = UpAxis::kZ;

void ExpectBox(const Scene& scene, const Vector3d& size_m) {
  scene.Validate("scene");
  EXPECT_TRUE(Bounds(scene).min().isZero(1e-6)) << Bounds(scene).min().transpose();
  EXPECT_TRUE(Bounds(scene).max().isApprox(size_m, 1e-6)) << Bounds(scene).max().transpose();
  EXPECT_EQ(scene.triangles.size(), 12u);
  EXPECT_EQ(scene.vertices_m.size(), 8u);  // shared, whatever the file repeats
  EXPECT_TRUE(IsClosed(scene));
  EXPECT_NEAR(SignedVolumeM3(scene), size_m.prod(), 1e-5);
}

// The area of a scene in one plane, all of whose triangles must turn as `up` says.
double AreaM2(const Scene& scene, const Vector3d& up) {
  double area_m2 = 0.0;
  for (const Eigen::Vector3i& triangle : scene.triangles) {
    const auto [a, b, c] = testing::Corners(scene, triangle);
    const Vector3d normal = 0.5 * (b - a).cross(c - a);
    EXPECT_GE(normal.dot(up), -1e-6);
    area_m2 += normal.norm();
  }
  return area_m2;
}

TEST(CadIoTest, ABoxOfQuadsAndMaterialsByName) {
  const Scene box = ParseObj(CubeObj(), "box.obj", {.up = kZ});
  ExpectBox(box, {1.0, 2.0, 3.0});
  EXPECT_THAT(box.material_names, ::testing::UnorderedElementsAre("old steel #2", "default"));
  // The face before the first `usemtl` has the default.
  int of_default = 0;
  for (const std::uint16_t material : box.triangle_material) {
    of_default += box.material_names[material] == "default" ? 1 : 0;
  }
  EXPECT_EQ(of_default, 2);
}

TEST(CadIoTest, EachFormatHasItsUsualUpwardAxis) {
  // 1 x 2 x 3 in the file: OBJ is Y up, world = (x, -z, y).
  const Scene obj = ParseObj(CubeObj(), "box.obj");
  EXPECT_TRUE(Bounds(obj).min().isApprox(Vector3d(0.0, -3.0, 0.0)));
  EXPECT_TRUE(Bounds(obj).max().isApprox(Vector3d(1.0, 0.0, 2.0)));
  EXPECT_NEAR(SignedVolumeM3(obj), 6.0, 1e-5);  // turned, not mirrored
  ExpectBox(ParseStl(BinaryStl(CubeFacets()), "box.stl"), {1.0, 2.0, 3.0});
  const Scene stl = ParseStl(BinaryStl(CubeFacets()), "box.stl", {.up = kY});
  EXPECT_EQ(Bounds(stl).max(), Bounds(obj).max());
}

TEST(CadIoTest, MetresPerUnitScalesTheScene) {
  ExpectBox(ParseObj(CubeObj(), "box.obj", {.metres_per_unit = 0.001, .up = kZ}), {0.001, 0.002, 0.003});
  ExpectBox(ParseStl(TextStl(CubeFacets()), "box.stl", {.metres_per_unit = 0.3048}),
            {0.3048, 0.6096, 0.9144});
  EXPECT_THROW(ParseStl(TextStl(CubeFacets()), "box.stl", {.metres_per_unit = 0.0}), DataError);
}

TEST(CadIoTest, TextAndBinaryStlAreTheSame) {
  const Scene text = ParseStl(TextStl(CubeFacets()), "box.stl");
  const Scene binary = ParseStl(BinaryStl(CubeFacets()), "box.stl");
  ExpectBox(text, {1.0, 2.0, 3.0});
  EXPECT_EQ(text.vertices_m, binary.vertices_m);
  EXPECT_EQ(text.triangles, binary.triangles);
  EXPECT_EQ(text.material_names, std::vector<std::string>{"default"});
  // A binary file whose header begins as a text file does.
  ExpectBox(ParseStl(BinaryStl(CubeFacets(), "solid made by a CAD"), "box.stl"), {1.0, 2.0, 3.0});
  // Colours in header and attributes change nothing.
  ExpectBox(ParseStl(BinaryStl(CubeFacets(), "COLOR=\1\2\3\4"), "box.stl"), {1.0, 2.0, 3.0});
  // Several solids are one scene.
  const auto facets = CubeFacets();
  const std::string two =
      TextStl({facets.begin(), facets.begin() + 5}) + TextStl({facets.begin() + 5, facets.end()});
  ExpectBox(ParseStl(two, "box.stl"), {1.0, 2.0, 3.0});
}

TEST(CadIoTest, TextAndBothByteOrdersOfPlyAreTheSame) {
  const Scene text = ParsePly(TextPly(), "box.ply");
  ExpectBox(text, {1.0, 2.0, 3.0});
  EXPECT_EQ(text.material_names, std::vector<std::string>{"default"});
  for (const bool big_endian : {false, true}) {
    const Scene binary = ParsePly(BinaryPly(big_endian), "box.ply");
    EXPECT_EQ(text.vertices_m, binary.vertices_m);
    EXPECT_EQ(text.triangles, binary.triangles);
  }
  // Lines may end as on any system, and blank lines may follow.
  std::string dos = TextPly();
  for (std::size_t at = dos.find('\n'); at != std::string::npos; at = dos.find('\n', at + 2))
    dos.insert(at, "\r");
  EXPECT_EQ(ParsePly(dos + "\r\n\r\n", "box.ply").triangles, text.triangles);
  ExpectBox(ParsePly(TextPly(), "box.ply", {.metres_per_unit = 0.001}), {0.001, 0.002, 0.003});
  const Scene turned = ParsePly(TextPly(), "box.ply", {.up = kY});
  EXPECT_EQ(Bounds(turned).max(), Bounds(ParseObj(CubeObj(), "box.obj")).max());
}

TEST(CadIoTest, ListsOfPlyMayHaveAnyIntegerType) {
  for (const bool big_endian : {false, true}) {
    for (const std::string& ply : {BinaryPly<std::int8_t, std::uint8_t>("char", "uint8", big_endian),
                                   BinaryPly<std::uint8_t, std::int8_t>("uint8", "char", big_endian),
                                   BinaryPly<std::int16_t, std::uint16_t>("short", "ushort", big_endian),
                                   BinaryPly<std::uint16_t, std::int16_t>("uint16", "int16", big_endian),
                                   BinaryPly<std::int32_t, std::uint32_t>("int", "uint32", big_endian),
                                   BinaryPly<std::uint32_t, std::int32_t>("uint", "int32", big_endian)}) {
      ExpectBox(ParsePly(ply, "box.ply"), {1.0, 2.0, 3.0});
    }
  }
}

TEST(CadIoTest, ConcavePolygonsOfPlyAreDivided) {
  // An L of 3 unit squares.
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n2 0 0\n2 1 0\n1 1 0\n1 2 0\n0 2 0\n6 0 1 2 3 4 5";
  const Scene scene = ParsePly(ply, "l.ply");
  EXPECT_EQ(scene.triangles.size(), 4u);
  EXPECT_NEAR(AreaM2(scene, Vector3d::UnitZ()), 3.0, 1e-6);
}

TEST(CadIoTest, NegativeIndicesCountBackwards) {
  const std::string obj =
      "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf -4 -1 -3\nf 2 4 5\nf -3 -1 -2\n";
  const Scene scene = ParseObj(obj, "tetrahedron.obj", {.up = kZ});
  EXPECT_EQ(scene.triangles.size(), 4u);
  EXPECT_EQ(scene.vertices_m.size(), 4u);  // that of no face is left out
  EXPECT_TRUE(IsClosed(scene));
  EXPECT_NEAR(std::abs(SignedVolumeM3(scene)), 1.0 / 6.0, 1e-6);
}

TEST(CadIoTest, PolygonsAreDividedEvenWhereTheyAreHollow) {
  // An L of six corners, area 3; the corner that looks inwards lies on a line between two others.
  const std::string l_shape = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n";
  for (const char* face : {"f 1 2 3 4 5 6\n", "f 4 5 6 1 2 3\n", "f 1// 2/7 3/7/7 \\\n 4//5 5 6\n"}) {
    const Scene scene = ParseObj(l_shape + face, "l.obj", {.up = kZ});
    EXPECT_EQ(scene.triangles.size(), 4u);
    EXPECT_NEAR(AreaM2(scene, Vector3d::UnitZ()), 3.0, 1e-6) << face;
  }
  EXPECT_NEAR(AreaM2(ParseObj(l_shape + "f 6 5 4 3 2 1\n", "l.obj", {.up = kZ}), -Vector3d::UnitZ()), 3.0,
              1e-6);
  // A square of side 3 with a hole of side 1, as one polygon that runs to the hole and back.
  const std::string ring =
      "v 0 0 0\nv 3 0 0\nv 3 3 0\nv 0 3 0\nv 1 1 0\nv 1 2 0\nv 2 2 0\nv 2 1 0\nf 1 2 3 4 1 5 6 7 8 5\n";
  EXPECT_NEAR(AreaM2(ParseObj(ring, "ring.obj", {.up = kZ}), Vector3d::UnitZ()), 8.0, 1e-6);
}

TEST(CadIoTest, StarsOfAnyShapeKeepTheirArea) {
  // Corners around the origin at random distances, in a tilted plane: every other ones look inwards.
  for (unsigned seed = 1; seed <= 40; ++seed) {
    std::mt19937 random(seed);
    const int corners = 4 + static_cast<int>(random() % 40);
    const Vector3d right = Vector3d(2.0, 1.0, 0.5).normalized();
    const Vector3d up = right.unitOrthogonal();
    const Vector3d ahead = up.cross(right);
    std::string obj;
    std::string face = "f";
    double expected_m2 = 0.0;
    Vector3d first_m = Vector3d::Zero();
    Vector3d before_m = Vector3d::Zero();
    for (int i = 0; i < corners; ++i) {
      const double radius_m = 0.2 + static_cast<double>(random() % 1000) / 1000.0;
      const double angle_rad = 2.0 * kPi * i / corners;
      const Vector3d corner_m = radius_m * (std::cos(angle_rad) * right + std::sin(angle_rad) * ahead);
      obj += fmt::format("v {} {} {}\n", corner_m.x(), corner_m.y(), corner_m.z());
      face += fmt::format(" {}", i + 1);
      if (i > 0) expected_m2 += 0.5 * before_m.cross(corner_m).dot(up);
      if (i == 0) first_m = corner_m;
      before_m = corner_m;
    }
    expected_m2 += 0.5 * before_m.cross(first_m).dot(up);
    const Scene scene = ParseObj(obj + face + "\n", "star.obj", {.up = kZ});
    EXPECT_EQ(scene.triangles.size(), static_cast<std::size_t>(corners - 2));
    EXPECT_NEAR(AreaM2(scene, expected_m2 > 0.0 ? up : Vector3d(-up)), std::abs(expected_m2), 1e-5) << seed;
  }
}

TEST(CadIoTest, LinesWithoutShapeAreIgnored) {
  const std::string obj =
      "\xEF\xBB\xBF# made by hand\r\nmtllib not_there.mtl ../../etc/passwd\r\no box\r\ng a b c\r\ns off\r\n"
      "v 0 0 0 0.5 0.5 0.5\r\nv 1 0 0 1.0\r\n\r\nv 0 1e0 -0.0\r\nvt 0 0\r\nvn 0 0 1\r\nusemtl rock\r\nl 1 "
      "2\r\np 3\r\n"
      "f 1/1/1 2/1/1 3/1/1  # a face\r\nusemtl unused\r\n";
  const Scene scene = ParseObj(obj, "one.obj");
  EXPECT_EQ(scene.triangles.size(), 1u);
  EXPECT_EQ(scene.material_names, std::vector<std::string>{"rock"});
}

TEST(CadIoTest, CoordinatesReadBackExactly) {
  const std::string obj =
      "v 1.23456789 -7.7e-5 33333.332\nv 0.1 16777217 0.333333343\nv +2.5 1e-30 -4\nf 1 2 3\n";
  const Scene scene = ParseObj(obj, "digits.obj", {.up = kZ});
  ASSERT_EQ(scene.vertices_m.size(), 3u);
  const std::vector<Eigen::Vector3f> expected = {
      {1.23456789F, -7.7e-5F, 33333.332F}, {0.1F, 16777216.0F, 0.333333343F}, {2.5F, 1e-30F, -4.0F}};
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) EXPECT_FLOAT_EQ(scene.vertices_m[i][k], expected[i][k]);
  }
}

TEST(CadIoTest, TheFileNameDecidesTheFormat) {
  const TempDir dir;
  WriteFile(dir / "box.OBJ", CubeObj());
  WriteFile(dir / "box.Stl", TextStl(CubeFacets()));
  WriteFile(dir / "box.PLY", BinaryPly());
  const Scene obj = ReadScene(dir / "box.OBJ", {.up = kZ});
  ExpectBox(obj, {1.0, 2.0, 3.0});
  ExpectBox(ReadScene(dir / "box.Stl"), {1.0, 2.0, 3.0});
  ExpectBox(ReadScene(dir / "box.PLY"), {1.0, 2.0, 3.0});
  WriteGltf(obj, dir / "box.glb");
  ExpectBox(ReadScene(dir / "box.glb"), {1.0, 2.0, 3.0});
  EXPECT_TRUE(NeedsConventions("a/b.STL"));
  EXPECT_TRUE(NeedsConventions("a/b.ply"));
  EXPECT_FALSE(NeedsConventions("a/b.gltf"));
  EXPECT_THROW(ReadScene(dir / "box.glb", {.up = kZ}), DataError);
  EXPECT_THROW(ReadScene(dir / "absent.obj"), DataError);
  EXPECT_THROW(ReadScene(dir.path()), DataError);
}

}  // namespace
}  // namespace sonarcal::data_io
