#include "data_io/scenes/scene_io.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/types/error.h"
#include "tests/data_io/gltf_builder.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/recordings.h"

namespace sonarcal::data_io {
namespace {

using Eigen::Vector3f;
using Eigen::Vector3i;
using nlohmann::json;
using testing::GltfBuilder;
using testing::OneTriangle;
using testing::TempDir;
using testing::Tetrahedron;
using testing::WriteFile;
using Names = std::vector<std::string>;

class SceneIoTest : public ::testing::Test {
 protected:
  Scene Read(const std::string& text, const std::string& name = "scene.gltf") {
    WriteFile(dir_ / name, text);
    return ReadGltf(dir_ / name);
  }
  Scene Read(const GltfBuilder& gltf) { return Read(gltf.Embedded()); }

  TempDir dir_;
};

Scene TwoMaterials() {
  Scene scene;
  scene.vertices_m = {{0, 0, 0}, {1.25f, 0, 0.1f}, {0, 2.5f, 1e-7f}, {-3.0f, 4.0f, 1e6f}, {9, 9, 9}};
  scene.triangles = {{0, 1, 2}, {2, 1, 3}, {3, 0, 1}};
  scene.triangle_material = {0, 0, 1};
  scene.material_names = {"floor", "wärts \"quoted\""};
  return scene;
}

TEST_F(SceneIoTest, AWrittenSceneComesBackExactly) {
  const Scene scene = TwoMaterials();
  for (const std::string name : {"scene.gltf", "scene.glb"}) {
    WriteGltf(scene, dir_ / name);
    const Scene read = ReadGltf(dir_ / name);
    EXPECT_EQ(read.vertices_m, scene.vertices_m) << name;
    EXPECT_EQ(read.triangles, scene.triangles) << name;
    EXPECT_EQ(read.triangle_material, scene.triangle_material) << name;
    EXPECT_EQ(read.material_names, scene.material_names) << name;
  }
}

TEST_F(SceneIoTest, MixedTrianglesComeBackGroupedByMaterial) {
  Scene scene = TwoMaterials();
  scene.triangle_material = {1, 0, 1};
  WriteGltf(scene, dir_ / "scene.glb");
  const Scene read = ReadGltf(dir_ / "scene.glb");
  EXPECT_EQ(read.triangles, (std::vector<Vector3i>{{2, 1, 3}, {0, 1, 2}, {3, 0, 1}}));
  EXPECT_EQ(read.triangle_material, (std::vector<std::uint16_t>{0, 1, 1}));
}

TEST_F(SceneIoTest, WritesYUpWithItsNameAndNothingBesideTheFile) {
  WriteGltf(TwoMaterials(), dir_ / "scene.gltf");
  const json root = json::parse(testing::ReadFile(dir_ / "scene.gltf"));
  EXPECT_EQ(root["asset"]["generator"], "sonarcal");
  EXPECT_EQ(root["asset"]["version"], "2.0");
  // World (-3, 4, 1e6) and (9, 9, 9) are glTF (-3, 1e6, -4) and (9, 9, -9).
  EXPECT_EQ(root["accessors"][0]["min"], json({-3.0, 0.0, -9.0}));
  EXPECT_EQ(root["accessors"][0]["max"], json({9.0, 1e6, 0.0}));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(dir_.path()), {}), 1);
}

TEST_F(SceneIoTest, InvalidScenesAndPathsAreRefusedAndLeaveNoFile) {
  EXPECT_THROW(WriteGltf(TwoMaterials(), dir_ / "scene.obj"), DataError);
  EXPECT_THROW(WriteGltf(TwoMaterials(), dir_ / "absent/scene.gltf"), DataError);
  EXPECT_THROW(WriteGltf(Scene{}, dir_ / "scene.gltf"), DataError);
  Scene not_utf8 = TwoMaterials();
  not_utf8.material_names[0] = "\xff\xfe";
  EXPECT_THROW(WriteGltf(not_utf8, dir_ / "scene.gltf"), DataError);
  EXPECT_THROW(WriteGltf(not_utf8, dir_ / "scene.glb"), DataError);
  EXPECT_TRUE(std::filesystem::is_empty(dir_.path()));
}

TEST_F(SceneIoTest, GltfIsYUpAndTheWorldZUp) {
  GltfBuilder gltf;
  const int positions = gltf.Positions({1, 2, 3, 4, 5, 6, 7, 8, 10});
  gltf.Show({{"attributes", {{"POSITION", positions}}}});
  EXPECT_EQ(Read(gltf).vertices_m, (std::vector<Vector3f>{{1, -3, 2}, {4, -6, 5}, {7, -10, 8}}));
}

TEST_F(SceneIoTest, BuffersMayBeEmbeddedBesideOrInTheBinaryChunk) {
  const GltfBuilder gltf = Tetrahedron();
  const Scene embedded = Read(gltf.Embedded());
  WriteFile(dir_ / "a mesh.bin", gltf.buffer);
  std::filesystem::create_directory(dir_ / "sub");
  WriteFile(dir_ / "sub/mesh.bin", gltf.buffer);
  for (const Scene& other : {Read(gltf.Glb(), "scene.glb"), Read(gltf.WithUri("a%20mesh.bin")),
                             Read(gltf.WithUri("sub/mesh.bin"))}) {
    EXPECT_EQ(other.vertices_m, embedded.vertices_m);
    EXPECT_EQ(other.triangles, embedded.triangles);
  }
}

TEST_F(SceneIoTest, IndicesMayHaveAnyWidthOrBeAbsent) {
  for (const int type : {testing::kU8, testing::kU16, testing::kU32, 0}) {
    GltfBuilder gltf;
    json primitive = {{"attributes", {{"POSITION", gltf.Positions({0, 0, 0, 1, 0, 0, 0, 1, 0})}}}};
    if (type == testing::kU8) primitive["indices"] = gltf.Accessor<std::uint8_t>({0, 1, 2}, type, "SCALAR");
    if (type == testing::kU16) primitive["indices"] = gltf.Accessor<std::uint16_t>({0, 1, 2}, type, "SCALAR");
    if (type == testing::kU32) primitive["indices"] = gltf.Accessor<std::uint32_t>({0, 1, 2}, type, "SCALAR");
    gltf.Show(primitive);
    EXPECT_EQ(Read(gltf).triangles, std::vector<Vector3i>{Vector3i(0, 1, 2)}) << type;
  }
}

TEST_F(SceneIoTest, StripsAndFansKeepTheirTurn) {
  const auto read = [&](int mode, const std::vector<std::uint8_t>& corners) {
    GltfBuilder gltf;
    const int positions = gltf.Positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 2, 2, 2});
    const int indices = gltf.Accessor(corners, testing::kU8, "SCALAR");
    gltf.Show({{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"mode", mode}});
    return Read(gltf).triangles;
  };
  EXPECT_EQ(read(5, {0, 1, 2, 3, 4}), (std::vector<Vector3i>{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}));
  EXPECT_EQ(read(6, {0, 1, 2, 3, 4}), (std::vector<Vector3i>{{1, 2, 0}, {2, 3, 0}, {3, 4, 0}}));
  EXPECT_EQ(read(5, {0, 1, 2, 2, 4, 3}), (std::vector<Vector3i>{{0, 1, 2}, {2, 3, 4}}));  // stitched
  EXPECT_THROW(read(1, {0, 1, 2}), DataError);
  EXPECT_THROW(read(4, {0, 1, 2, 3}), DataError);
  EXPECT_THROW(read(5, {0, 1}), DataError);
}

TEST_F(SceneIoTest, InterleavedAndOffsetElementsAreFound) {
  GltfBuilder gltf;
  // position and normal by turns, after one float of something else
  const std::vector<float> words = {7, 1, 2, 3, 0, 0, 1, 4, 5, 6, 0, 0, 1, 7, 8, 10, 0, 0, 1};
  const int positions = gltf.Accessor(words, testing::kFloat, "SCALAR");
  gltf.root["accessors"][positions].update({{"type", "VEC3"}, {"count", 3}, {"byteOffset", 4}});
  gltf.root["bufferViews"][0]["byteStride"] = 24;
  gltf.Show({{"attributes", {{"POSITION", positions}}}});
  EXPECT_EQ(Read(gltf).vertices_m, (std::vector<Vector3f>{{1, -3, 2}, {4, -6, 5}, {7, -10, 8}}));
  gltf.root["accessors"][positions]["count"] = 4;
  EXPECT_THROW(Read(gltf), DataError);
}

TEST_F(SceneIoTest, TransformsOfNestedNodesAreApplied) {
  GltfBuilder gltf = OneTriangle();
  const double half = std::sqrt(0.5);
  gltf.root["nodes"][0].update({{"translation", {10, 0, 0}}, {"scale", {2, 2, 2}}});
  // Its parent turns by 90 degrees about glTF's y (x to -z); the grandparent lifts by 5.
  gltf.Add("nodes", {{"children", {0}}, {"rotation", {0, half, 0, half}}});
  gltf.Add("nodes", {{"children", {1}}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 5, 0, 1}}});
  gltf.root["scenes"][0]["nodes"] = {2};
  const Scene scene = Read(gltf);
  ASSERT_EQ(scene.vertices_m.size(), 3u);
  // glTF (1,0,0) -> (12,0,0) -> (0,0,-12) -> (0,5,-12) -> world (0,12,5)
  EXPECT_TRUE(scene.vertices_m[1].isApprox(Vector3f(0, 12, 5), 1e-6f)) << scene.vertices_m[1].transpose();
  EXPECT_TRUE(scene.vertices_m[2].isApprox(Vector3f(0, 10, 7), 1e-6f)) << scene.vertices_m[2].transpose();
}

TEST_F(SceneIoTest, AMirroredMeshKeepsFacingOutwards) {
  GltfBuilder gltf = Tetrahedron();
  EXPECT_NEAR(testing::SignedVolumeM3(Read(gltf)), 1.0 / 6.0, 1e-6);
  gltf.root["nodes"][0]["scale"] = {-2, 1, 1};
  EXPECT_NEAR(testing::SignedVolumeM3(Read(gltf)), 2.0 / 6.0, 1e-6);
  gltf.root["nodes"][0]["scale"] = {-2, -1, 1};
  EXPECT_NEAR(testing::SignedVolumeM3(Read(gltf)), 2.0 / 6.0, 1e-6);
}

TEST_F(SceneIoTest, AMeshMayBeShownByManyNodesAndScenesBeAbsent) {
  GltfBuilder gltf = Tetrahedron();
  gltf.Add("nodes", {{"mesh", 0}, {"translation", {5, 0, 0}}});
  gltf.root.erase("scenes");
  const Scene scene = Read(gltf);
  EXPECT_EQ(scene.triangles.size(), 8u);
  EXPECT_NEAR(testing::SignedVolumeM3(scene), 2.0 / 6.0, 1e-5);
}

TEST_F(SceneIoTest, OnlyTheDefaultSceneIsRead) {
  GltfBuilder gltf = Tetrahedron();
  gltf.Add("nodes", {{"mesh", 0}, {"translation", {5, 0, 0}}});
  gltf.Add("scenes", {{"nodes", {1}}});
  gltf.root["scene"] = 1;
  EXPECT_NEAR(Read(gltf).vertices_m[0].x(), 5.0f, 1e-6f);
}

TEST_F(SceneIoTest, MaterialsGoByName) {
  GltfBuilder gltf;
  const int positions = gltf.Positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  gltf.root["materials"] = {
      {{"name", "unused"}},
      {{"name", "wall"}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 9}}}}}},
      json::object(),
      {{"name", "wall"}},
      {{"name", "floor"}}};
  const json attributes = {{"POSITION", positions}};
  for (const int material : {4, 3, 2, -1, 1}) {
    json primitive = {{"attributes", attributes}};
    if (material >= 0) primitive["material"] = material;
    gltf.Show(primitive);
  }
  const Scene scene = Read(gltf);
  EXPECT_EQ(scene.material_names, (Names{"wall", "material_2", "floor", "default"}));
  EXPECT_EQ(scene.triangle_material, (std::vector<std::uint16_t>{2, 0, 1, 3, 0}));
}

TEST_F(SceneIoTest, SeveralPrimitivesOfAMeshShareTheirVertices) {
  GltfBuilder gltf = OneTriangle();
  json& primitives = gltf.root["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  const Scene scene = Read(gltf);
  EXPECT_EQ(scene.vertices_m.size(), 3u);
  EXPECT_EQ(scene.triangles.size(), 2u);
}

TEST_F(SceneIoTest, PicturesAndOtherPartsWithoutShapeAreIgnored) {
  GltfBuilder gltf = OneTriangle();
  gltf.root["images"] = {{{"uri", "absent.png"}},
                         {{"uri", "../../etc/passwd"}},
                         {{"bufferView", 77}, {"mimeType", "image/png"}},
                         {{"uri", "data:image/png;base64,AAAA"}}};
  gltf.root["textures"] = {{{"source", 5}}};
  gltf.root["skins"] = "nonsense";
  gltf.root["animations"] = {1, 2, 3};
  gltf.root["extensionsRequired"] = {"KHR_materials_unlit"};
  gltf.root["extensions"] = {{"KHR_lights_punctual", 3}};
  gltf.root["nodes"][0]["extras"] = {{"anything", "at all"}};
  EXPECT_EQ(Read(gltf).triangles.size(), 1u);
}

TEST_F(SceneIoTest, TheSyntheticTankIsRead) {
  SONARCAL_NEEDS_RECORDING(path, "synthetic_tank/scene.gltf");
  const Scene scene = ReadGltf(path);
  EXPECT_EQ(scene.material_names, (Names{"floor", "wall", "mockup", "surface"}));
  EXPECT_EQ(scene.triangles.size(), (6u + 24u + 1476u + 6u) / 3u);
  const Eigen::AlignedBox3d bounds = testing::Bounds(scene);
  EXPECT_TRUE(bounds.min().isApprox(Eigen::Vector3d::Zero(), 1e-6));
  EXPECT_TRUE(bounds.max().isApprox(Eigen::Vector3d(12.0, 10.0, 1.5), 1e-6));
  WriteGltf(scene, dir_ / "again.glb");
  EXPECT_EQ(ReadGltf(dir_ / "again.glb").vertices_m, scene.vertices_m);
}

}  // namespace
}  // namespace sonarcal::data_io
