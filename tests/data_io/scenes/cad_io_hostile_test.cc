// What OBJ, STL and PLY readers owe a hostile file: a scene that is valid, or a DataError that names it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/types/error.h"
#include "core/types/parameters.h"
#include "data_io/scenes/cad_io.h"
#include "data_io/scenes/cad_mesh.h"
#include "tests/data_io/cad_files.h"
#include "tests/data_io/refusal.h"

namespace sonarcal::data_io {
namespace {

using testing::BinaryPly;
using testing::BinaryStl;
using testing::CubeFacets;
using testing::CubeObj;
using ::testing::HasSubstr;
using testing::TextPly;
using testing::TextStl;

// What the refusal of a file says; empty where it is read.
template <typename Parse>
std::string RefusalOf(const Parse& parse, const std::string& bytes, const std::string& name) {
  try {
    parse(bytes, name, SceneConventions{}).Validate("read");
    return {};
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr(name));
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.what();
  } catch (const std::exception& error) {
    ADD_FAILURE() << "something else than a DataError: " << error.what();
    return error.what();
  }
}

std::string ObjRefusal(const std::string& bytes) {
  return RefusalOf(ParseObj, bytes, "scene.obj");
}

std::string StlRefusal(const std::string& bytes) {
  return RefusalOf(ParseStl, bytes, "scene.stl");
}

std::string PlyRefusal(const std::string& bytes) {
  return RefusalOf(ParsePly, bytes, "scene.ply");
}

constexpr const char* kThree = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

TEST(ObjHostileTest, InvalidLinesAreRefusedWithTheirNumber) {
  EXPECT_EQ(ObjRefusal(std::string(kThree) + "f 1 2 3\n"), "");
  EXPECT_THAT(ObjRefusal(""), HasSubstr("no faces"));
  EXPECT_THAT(ObjRefusal(kThree), HasSubstr("no faces"));
  EXPECT_THAT(ObjRefusal("v 0 0 nan\n"),
              HasSubstr("scene.obj:1: 'nan' in a vertex, expected a finite number"));
  EXPECT_THAT(ObjRefusal("v 0 -inf 0\n"), HasSubstr("'-inf'"));
  EXPECT_THAT(ObjRefusal("v 0 1e39 0\n"), HasSubstr("'1e39'"));
  EXPECT_THAT(ObjRefusal("v 0 1e999 0\n"), HasSubstr("'1e999'"));
  EXPECT_THAT(ObjRefusal("v 0 0x1 0\n"), HasSubstr("'0x1'"));
  EXPECT_THAT(ObjRefusal("v 0 1,5 0\n"), HasSubstr("'1,5'"));
  EXPECT_THAT(ObjRefusal("v 0 1\n"), HasSubstr("2 numbers"));
  EXPECT_THAT(ObjRefusal("v 0 1 2 3 4\n"), HasSubstr("5 numbers"));
  EXPECT_THAT(ObjRefusal("v 1 2 3 4 5 6 7 8\n"), HasSubstr("more than 7"));
  EXPECT_THAT(ObjRefusal("v 0 1 2 0.5\n"), HasSubstr("weight 0.5"));
  EXPECT_THAT(ObjRefusal(std::string(kThree) + "\nf 1 2 4\n"),
              HasSubstr(":5: vertex 4 in a face, but 3 stand before it"));
  EXPECT_THAT(ObjRefusal(std::string(kThree) + "f 1 2 -4\n"), HasSubstr(":4: vertex -4"));
  EXPECT_THAT(ObjRefusal(std::string(kThree) + "f 0 1 2\n"), HasSubstr("vertex 0"));
  EXPECT_THAT(ObjRefusal(std::string(kThree) + "f 1 2\n"), HasSubstr("2 corners"));
  EXPECT_THAT(ObjRefusal(std::string(kThree) + "f\n"), HasSubstr("0 corners"));
  EXPECT_THAT(ObjRefusal(std::string(kThree) + "f 1 2 3.5\n"), HasSubstr("'3.5'"));
  EXPECT_THAT(ObjRefusal(std::string(kThree) + "f 1/1/1/1 2 3\n"), HasSubstr("at most 3 indices"));
  EXPECT_THAT(ObjRefusal(std::string(kThree) + "f /1 2 3\n"), HasSubstr("'/1'"));
  EXPECT_THAT(ObjRefusal(std::string(kThree) + "f 1 2 99999999999999999999\n"), HasSubstr("in a face"));
  EXPECT_THAT(ObjRefusal(std::string(kThree) + "f 1 2 -9223372036854775808\n"), HasSubstr("in a face"));
  EXPECT_THAT(ObjRefusal(std::string(kThree) + "f 1 2 4294967297\n"), HasSubstr("in a face"));
  EXPECT_THAT(ObjRefusal("surf 0 1 0 1\n"), HasSubstr("free-form"));
  EXPECT_THAT(ObjRefusal("call /etc/passwd\n"), HasSubstr("'call'"));
  EXPECT_THAT(ObjRefusal("\x1b[31mred\n"), HasSubstr("'?[31mred', which is no statement"));
  EXPECT_THAT(ObjRefusal(std::string(5000, 'x')), HasSubstr("no statement"));
  EXPECT_THAT(ObjRefusal(BinaryStl(CubeFacets())), HasSubstr("scene.obj:1"));
}

TEST(ObjHostileTest, FacesAndMaterialsBeyondTheLimitsAreRefused) {
  std::string polygon = kThree;
  polygon += "f";
  for (std::size_t i = 0; i <= kMaxFaceCorners; ++i) polygon += " 1";
  EXPECT_THAT(ObjRefusal(polygon), HasSubstr("more than 1000 corners"));
  std::string materials = kThree;
  for (std::size_t i = 0; i <= kMaxMaterials; ++i) materials += fmt::format("usemtl m{}\nf 1 2 3\n", i);
  EXPECT_THAT(ObjRefusal(materials), HasSubstr("more than 4096 materials"));
  std::string groups = kThree;
  for (int i = 0; i < 20000; ++i)
    groups += fmt::format("o part{0}\ng part{0}\nusemtl m{1}\nf 1 2 3\n", i, i % 2);
  EXPECT_EQ(ObjRefusal(groups), "");
  const Scene scene = ParseObj(groups, "groups.obj");
  EXPECT_EQ(scene.triangles.size(), 20000u);
  EXPECT_EQ(scene.material_names.size(), 2u);
}

TEST(ObjHostileTest, FacesThatCannotBeDividedAreRefusedRatherThanLeftOut) {
  // Corners all in one place, in a line, crossing, or named twice: read or refused, never lost in silence.
  const std::string points = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 0 1 0\nv 1 1 0\n";
  for (const char* face : {"f 1 1 1", "f 1 1 1 1", "f 1 1 1 1 1", "f 1 2 3 4", "f 1 2 3 4 1", "f 1 6 2 5",
                           "f 1 6 5 2 6 1", "f 1 2 1 2 1 2 1"}) {
    const std::string obj = points + face + "\n";
    const std::size_t corners =
        std::count(obj.begin() + static_cast<std::ptrdiff_t>(points.size()), obj.end(), ' ');
    try {
      EXPECT_EQ(ParseObj(obj, "face.obj").triangles.size(), corners - 2) << face;
    } catch (const DataError& error) {
      EXPECT_THAT(error.what(), HasSubstr("sides cross")) << face;
    }
  }
}

TEST(StlHostileTest, CountsBeyondTheFileAreRefused) {
  const std::string whole = BinaryStl(CubeFacets());
  EXPECT_EQ(StlRefusal(whole), "");
  for (const std::uint32_t count : {0U, 11U, 13U, 20'000'001U, 0xFFFFFFFFU}) {
    std::string bytes = whole;
    std::memcpy(bytes.data() + 80, &count, 4);
    EXPECT_THAT(StlRefusal(bytes), HasSubstr(fmt::format("claims {} triangles", count)));
  }
  EXPECT_THAT(StlRefusal(whole + "x"), HasSubstr("has 685"));
  EXPECT_THAT(StlRefusal(BinaryStl({})), HasSubstr("no triangles"));
  EXPECT_THAT(StlRefusal(""), HasSubstr("'solid'"));
  EXPECT_THAT(StlRefusal("solid"), HasSubstr("ends in line 1, expected 'endsolid'"));
  EXPECT_THAT(StlRefusal("solid x\nendsolid x\n"), HasSubstr("no triangles"));
}

TEST(StlHostileTest, TextThatIsNoStlIsRefusedWithItsLine) {
  const std::string whole = TextStl(CubeFacets());
  const auto damaged = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    text.replace(text.find(from), from.size(), to);
    return StlRefusal(text);
  };
  EXPECT_THAT(damaged("facet", "face"), HasSubstr("scene.stl:2: 'face', expected 'endsolid'"));
  EXPECT_THAT(damaged("outer", "inner"), HasSubstr(":3: 'inner', expected 'outer'"));
  EXPECT_THAT(damaged("vertex 0", "vertex O"), HasSubstr(":4: 'O', expected 'a number'"));
  EXPECT_THAT(damaged("vertex 0", "vertex nan"), HasSubstr("finite"));
  EXPECT_THAT(damaged("vertex 0", "vertex -inf"), HasSubstr("finite"));
  EXPECT_THAT(damaged("vertex 0", "vertex 1e99"), HasSubstr("finite"));
  EXPECT_NE(damaged("vertex 0", "vertex ee"), "");
  EXPECT_THAT(damaged("endloop", "vertex"), HasSubstr("expected 'endloop'"));
  EXPECT_THAT(damaged("endsolid a box\n", ""), HasSubstr("expected 'endsolid'"));
  std::string solids;
  for (std::size_t i = 0; i <= kMaxStlSolids; ++i) solids += "solid\nendsolid\n";
  EXPECT_THAT(StlRefusal(solids), HasSubstr("more than 4096 solids"));
}

TEST(StlHostileTest, VerticesThatAreNotFiniteAreRefused) {
  for (const float value :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    auto facets = CubeFacets();
    facets[3][1][2] = value;
    EXPECT_THAT(StlRefusal(BinaryStl(facets)), HasSubstr("finite"));
  }
}

TEST(StlHostileTest, FilesCutShortAreRefused) {
  for (const std::string& whole : {BinaryStl(CubeFacets()), TextStl(CubeFacets())}) {
    const std::size_t end = whole.find("endsolid");
    for (std::size_t length = 0; length < std::min(end, whole.size()); ++length) {
      EXPECT_NE(StlRefusal(whole.substr(0, length)), "") << length;
    }
  }
}

// A PLY of three vertices and one face, with one text in place of another.
std::string PlyWith(const std::string& from, const std::string& to) {
  std::string text =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  text.replace(text.find(from), from.size(), to);
  return PlyRefusal(text);
}

TEST(PlyHostileTest, HeadersOfAnotherFormAreRefusedWithTheirLine) {
  EXPECT_EQ(PlyWith("ascii", "ascii"), "");
  EXPECT_THAT(PlyRefusal(""), HasSubstr("the header does not end"));
  EXPECT_THAT(PlyRefusal("plyx\n"), HasSubstr("does not begin with 'ply'"));
  EXPECT_THAT(PlyRefusal("ply\nend_header\n"), HasSubstr("no format"));
  EXPECT_THAT(PlyWith("ascii 1.0", "ascii 2.0"), HasSubstr("scene.ply:2: version '2.0', expected 1.0"));
  EXPECT_THAT(PlyWith("ascii", "binary"), HasSubstr("format 'binary'"));
  EXPECT_THAT(PlyWith("element vertex 3", "element vertex -3"), HasSubstr(":3: '-3', expected the number"));
  EXPECT_THAT(PlyWith("element vertex 3", "element vertex 99999999999999999999"),
              HasSubstr("expected the number"));
  EXPECT_THAT(PlyWith("element vertex", "elements vertex"), HasSubstr("'elements', which is no line"));
  EXPECT_THAT(PlyWith("float y", "real y"), HasSubstr(":5: type 'real'"));
  EXPECT_THAT(PlyWith("float y", "float t"), HasSubstr("no property 'y'"));
  EXPECT_THAT(PlyWith("float y", "list uchar float y"), HasSubstr("no property 'y'"));
  EXPECT_THAT(PlyWith("float y", "float"), HasSubstr("without a name"));
  EXPECT_THAT(PlyWith("element vertex 3\n", ""), HasSubstr("before the first element"));
  EXPECT_THAT(PlyWith("element face 1", "element vertex 1"), HasSubstr("a second element 'vertex'"));
  EXPECT_THAT(PlyWith("element face 1", "element strip 1"), HasSubstr("no faces"));
  EXPECT_THAT(PlyWith("vertex_indices", "corners"), HasSubstr("no list 'vertex_indices'"));
  EXPECT_THAT(PlyWith("uchar int", "float int"), HasSubstr("counted in floating-point"));
  EXPECT_THAT(PlyWith("uchar int", "uchar float"), HasSubstr("expected integers"));
  EXPECT_THAT(PlyWith("end_header\n", ""), HasSubstr("is no line of a PLY header"));
  EXPECT_THAT(PlyWith("float z\n", "float z\n" + std::string(5000, 'c') + "\n"), HasSubstr("does not end"));
  std::string lines;
  for (std::size_t i = 0; i <= kMaxPlyHeaderLines; ++i) lines += "comment\n";
  EXPECT_THAT(PlyWith("end_header", lines + "end_header"), HasSubstr("more than 1000 lines"));
}

TEST(PlyHostileTest, NumbersAndFacesThatDoNotFitAreRefused) {
  EXPECT_THAT(PlyWith("1 0 0", "1 O 0"), HasSubstr("scene.ply:11: 'O', expected a number"));
  EXPECT_THAT(PlyWith("1 0 0", "1 nan 0"), HasSubstr("vertex 1 is not finite"));
  EXPECT_THAT(PlyWith("1 0 0", "1 1e39 0"), HasSubstr("vertex 1 is not finite"));
  EXPECT_THAT(PlyWith("3 0 1 2", "3 0 1 3"), HasSubstr("face 0 has vertex 3, but there are 3"));
  EXPECT_THAT(PlyWith("3 0 1 2", "3 0 1 -1"), HasSubstr("face 0 has vertex -1"));
  EXPECT_THAT(PlyWith("3 0 1 2", "3 0 1 2147483648"), HasSubstr("expected a number of type int"));
  EXPECT_THAT(PlyWith("3 0 1 2", "3 0 1 1.5"), HasSubstr(":13: '1.5', expected an integer"));
  EXPECT_THAT(PlyWith("3 0 1 2", "2 0 1"), HasSubstr("face 0 has 2 corners"));
  EXPECT_THAT(PlyWith("3 0 1 2", "300 0 1"), HasSubstr("expected a number of type uchar"));
  EXPECT_THAT(PlyWith("3 0 1 2", "3 0 1"), HasSubstr("the text ends, expected a number"));
  EXPECT_THAT(PlyWith("3 0 1 2", "3 0 1 2 9"), HasSubstr("data follow the last element"));
  EXPECT_THAT(PlyWith("uchar int", "uint int"), "");
}

TEST(PlyHostileTest, CountsBeyondTheFileAreRefused) {
  EXPECT_THAT(PlyWith("element vertex 3", "element vertex 18446744073709551615"),
              HasSubstr("18446744073709551615 elements 'vertex' take at least 6 bytes each"));
  EXPECT_THAT(PlyWith("element face 1", "element face 4000000000"), HasSubstr("4000000000 elements 'face'"));
  EXPECT_THAT(PlyWith("element face 1", "element nothing 18446744073709551615\nelement face 1"), "");
  std::string list = BinaryPly();
  const std::size_t edge = list.find("end_header") + 12 + 8 * 18;  // the count of the list to skip
  list[edge] = '\xff';
  EXPECT_NE(PlyRefusal(list), "");
  for (const std::string& whole : {BinaryPly(false), BinaryPly(true)}) {
    for (std::size_t length = 0; length < whole.size(); ++length)
      EXPECT_NE(PlyRefusal(whole.substr(0, length)), "") << length;
    EXPECT_THAT(PlyRefusal(whole + "x"), HasSubstr("data follow the last element"));
  }
  const std::string text = TextPly();
  for (std::size_t length = 0; length + 1 < text.size(); ++length)
    EXPECT_NE(PlyRefusal(text.substr(0, length)), "") << length;
}

TEST(CadHostileTest, DamagedBytesMakeAValidSceneOrADataError) {
  const auto read_obj = [](const std::string& bytes) { ParseObj(bytes, "damaged.obj").Validate("read"); };
  const auto read_stl = [](const std::string& bytes) { ParseStl(bytes, "damaged.stl").Validate("read"); };
  testing::ExpectSurvivesDamage(CubeObj(), 400, 2000, read_obj);
  testing::ExpectSurvivesDamage(TextStl(CubeFacets()), 400, 2000, read_stl);
  testing::ExpectSurvivesDamage(BinaryStl(CubeFacets()), 400, 2000, read_stl);
  const auto read_ply = [](const std::string& bytes) { ParsePly(bytes, "damaged.ply").Validate("read"); };
  testing::ExpectSurvivesDamage(TextPly(), 400, 2000, read_ply);
  testing::ExpectSurvivesDamage(BinaryPly(false), 400, 2000, read_ply);
  testing::ExpectSurvivesDamage(BinaryPly(true), 400, 2000, read_ply);
}

}  // namespace
}  // namespace sonarcal::data_io
