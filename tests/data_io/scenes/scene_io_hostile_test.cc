// What ReadGltf owes a hostile file: a scene that is valid, or a DataError that names the file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <random>

#include "core/types/error.h"
#include "data_io/scenes/gltf_document.h"
#include "data_io/scenes/scene_assembler.h"
#include "data_io/scenes/scene_io.h"
#include "tests/data_io/gltf_builder.h"

namespace sonarcal::data_io {
namespace {

using nlohmann::json;
using testing::GltfBuilder;
using ::testing::HasSubstr;
using testing::OneTriangle;
using testing::TempDir;
using testing::Tetrahedron;
using testing::WriteFile;

class SceneIoHostileTest : public ::testing::Test {
 protected:
  // What the refusal of a file says; empty where it is read.
  std::string RefusalOf(const std::string& bytes, const std::string& name = "scene.gltf") {
    try {
      ParseGltf(bytes, dir_ / name).Validate("read");
      return {};
    } catch (const DataError& error) {
      EXPECT_THAT(error.what(), HasSubstr(name));
      return error.what();
    } catch (const std::exception& error) {
      ADD_FAILURE() << "something else than a DataError: " << error.what();
      return error.what();
    }
  }

  // Applies `damage` to a tetrahedron and expects the refusal to say `words`.
  void ExpectRefusal(const std::string& words, const std::function<void(GltfBuilder&)>& damage) {
    GltfBuilder gltf = Tetrahedron();
    damage(gltf);
    EXPECT_THAT(RefusalOf(gltf.Embedded()), HasSubstr(words));
    EXPECT_THAT(RefusalOf(gltf.Glb(), "scene.glb"), HasSubstr(words));
  }

  TempDir dir_;
};

TEST_F(SceneIoHostileTest, FilesThatAreNoGltfAreRefused) {
  EXPECT_THROW(ReadGltf(dir_ / "absent.gltf"), DataError);
  EXPECT_THROW(ReadGltf(dir_.path()), DataError);
  EXPECT_THAT(RefusalOf(""), HasSubstr("JSON"));
  EXPECT_THAT(RefusalOf("solid cube"), HasSubstr("JSON"));
  EXPECT_THAT(RefusalOf("[1, 2]"), HasSubstr("asset.version"));
  EXPECT_THAT(RefusalOf("{}"), HasSubstr("asset.version"));
  EXPECT_THAT(RefusalOf(R"({"asset": {"version": "1.0"}})"), HasSubstr("version 1.0"));
  EXPECT_THAT(RefusalOf(R"({"asset": {"version": "2.0"}})"), HasSubstr("no triangles"));
  EXPECT_THAT(RefusalOf("{\"asset\": {\"version\": \"2.0\"}, \"\xff\": 1}"), HasSubstr("JSON"));
}

TEST_F(SceneIoHostileTest, AccessorsBeyondTheirBuffersAreRefused) {
  ExpectRefusal("claims 5 elements", [](auto& gltf) { gltf.root["accessors"][0]["count"] = 5; });
  ExpectRefusal("claims 2000000000", [](auto& gltf) { gltf.root["accessors"][0]["count"] = 2'000'000'000; });
  ExpectRefusal("whole number", [](auto& gltf) { gltf.root["accessors"][0]["count"] = 1ULL << 63; });
  ExpectRefusal("whole number", [](auto& gltf) { gltf.root["accessors"][0]["count"] = -1; });
  ExpectRefusal("claims 0", [](auto& gltf) { gltf.root["accessors"][1]["count"] = 0; });
  ExpectRefusal("claims 4", [](auto& gltf) { gltf.root["accessors"][0]["byteOffset"] = 4; });
  ExpectRefusal("claims 4", [](auto& gltf) { gltf.root["accessors"][0]["byteOffset"] = 2'000'000'000; });
  ExpectRefusal("whole number", [](auto& gltf) { gltf.root["accessors"][0]["byteOffset"] = -4; });
  ExpectRefusal("ends beyond", [](auto& gltf) { gltf.root["bufferViews"][1]["byteLength"] = 4096; });
  ExpectRefusal("ends beyond", [](auto& gltf) { gltf.root["bufferViews"][0]["byteOffset"] = 2147483647; });
  ExpectRefusal("stride of 4", [](auto& gltf) { gltf.root["bufferViews"][0]["byteStride"] = 4; });
  ExpectRefusal("buffer 1 is named", [](auto& gltf) { gltf.root["bufferViews"][0]["buffer"] = 1; });
  ExpectRefusal("buffer view 9", [](auto& gltf) { gltf.root["accessors"][0]["bufferView"] = 9; });
  ExpectRefusal("no buffer view", [](auto& gltf) { gltf.root["accessors"][0].erase("bufferView"); });
  ExpectRefusal("sparse", [](auto& gltf) { gltf.root["accessors"][0]["sparse"] = {{"count", 1}}; });
  ExpectRefusal("normalized", [](auto& gltf) { gltf.root["accessors"][1]["normalized"] = true; });
  ExpectRefusal("float VEC3", [](auto& gltf) { gltf.root["accessors"][0]["type"] = "VEC2"; });
  ExpectRefusal("float VEC3", [](auto& gltf) { gltf.root["accessors"][0]["componentType"] = testing::kU16; });
  ExpectRefusal("unsigned scalar", [](auto& gltf) { gltf.root["accessors"][1]["componentType"] = 5120; });
}

TEST_F(SceneIoHostileTest, ReferencesToAbsentObjectsAreRefused) {
  const auto primitive = [](GltfBuilder& gltf) -> json& { return gltf.root["meshes"][0]["primitives"][0]; };
  ExpectRefusal("accessor 7", [&](auto& gltf) { primitive(gltf)["attributes"]["POSITION"] = 7; });
  ExpectRefusal("accessor", [&](auto& gltf) { primitive(gltf)["indices"] = 7; });
  ExpectRefusal("material 3", [&](auto& gltf) { primitive(gltf)["material"] = 3; });
  ExpectRefusal("material 0 of 0 is named", [&](auto& gltf) { primitive(gltf)["material"] = 0; });
  ExpectRefusal("POSITION", [&](auto& gltf) { primitive(gltf).erase("attributes"); });
  ExpectRefusal("POSITION", [&](auto& gltf) { primitive(gltf)["attributes"] = {{"NORMAL", 0}}; });
  ExpectRefusal("not an object", [&](auto& gltf) { primitive(gltf) = 3; });
  ExpectRefusal("mesh 4", [](auto& gltf) { gltf.root["nodes"][0]["mesh"] = 4; });
  ExpectRefusal("node 8", [](auto& gltf) { gltf.root["scenes"][0]["nodes"] = {8}; });
  ExpectRefusal("node 8", [](auto& gltf) { gltf.root["nodes"][0]["children"] = {8}; });
  ExpectRefusal("scene 2", [](auto& gltf) { gltf.root["scene"] = 2; });
  ExpectRefusal("names vertex 9 of 4", [](auto& gltf) { gltf.buffer[48] = 9; });
}

TEST_F(SceneIoHostileTest, NodesThatAreNoTreeAreRefused) {
  ExpectRefusal("reached twice", [](auto& gltf) { gltf.root["nodes"][0]["children"] = {0}; });
  ExpectRefusal("reached twice", [](auto& gltf) { gltf.root["scenes"][0]["nodes"] = {0, 0}; });
  ExpectRefusal("no triangles", [](auto& gltf) {  // a cycle that no root reaches
    gltf.root["nodes"][0]["children"] = {0};
    gltf.root.erase("scenes");
  });
  ExpectRefusal("nested deeper", [](auto& gltf) {
    for (int i = 0; i < 1000; ++i) gltf.Add("nodes", {{"children", {i}}});
    gltf.root["scenes"][0]["nodes"] = {1000};
  });
  ExpectRefusal("array of 16", [](auto& gltf) { gltf.root["nodes"][0]["matrix"] = {1, 0, 0}; });
  ExpectRefusal("array of 3", [](auto& gltf) { gltf.root["nodes"][0]["scale"] = {1, "2", 3}; });
  ExpectRefusal("no length", [](auto& gltf) { gltf.root["nodes"][0]["rotation"] = {0, 0, 0, 0}; });
  ExpectRefusal("row 0 0 0 1",
                [](auto& gltf) { gltf.root["nodes"][0]["matrix"] = json(std::vector(16, 1.0)); });
  ExpectRefusal("whole numbers", [](auto& gltf) { gltf.root["nodes"][0]["children"] = "0"; });
}

TEST_F(SceneIoHostileTest, VerticesThatAreNowhereAreRefused) {
  for (const float value :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    ExpectRefusal("finite", [&](auto& gltf) { std::memcpy(gltf.buffer.data() + 16, &value, sizeof(value)); });
  }
  ExpectRefusal("finite", [](auto& gltf) { gltf.root["nodes"][0]["scale"] = {1e300, 1, 1}; });
}

TEST_F(SceneIoHostileTest, CompressedFilesAreRefusedByName) {
  for (const char* extension :
       {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_mesh_quantization"}) {
    ExpectRefusal(extension, [&](auto& gltf) { gltf.root["extensionsRequired"] = {extension}; });
  }
}

TEST_F(SceneIoHostileTest, BuffersOutsideTheDirectoryAreRefused) {
  const GltfBuilder gltf = Tetrahedron();
  std::filesystem::create_directory(dir_ / "sub");
  WriteFile(dir_ / "mesh.bin", gltf.buffer);
  for (const std::string& uri :
       {std::string("../mesh.bin"), std::string("%2e%2e/mesh.bin"), std::string("x/../../mesh.bin"),
        (dir_ / "mesh.bin").string(), std::string("/dev/zero")}) {
    EXPECT_THAT(RefusalOf(gltf.WithUri(uri), "sub/scene.gltf"), HasSubstr("outside the file's own directory"))
        << uri;
  }
}

TEST_F(SceneIoHostileTest, BuffersOfAnotherLengthOrEncodingAreRefused) {
  const GltfBuilder gltf = Tetrahedron();
  EXPECT_THAT(RefusalOf(gltf.WithUri("absent.bin")), HasSubstr("no such file"));
  EXPECT_THAT(RefusalOf(gltf.WithUri(".")), HasSubstr("not a file"));
  EXPECT_THAT(RefusalOf(gltf.WithUri("")), HasSubstr("uri"));
  EXPECT_NE(RefusalOf(gltf.WithUri("https://example.org/mesh.bin")), "");
  EXPECT_NE(RefusalOf(gltf.WithUri("data:application/octet-stream;base64,AAAA")), "");
  EXPECT_NE(RefusalOf(gltf.WithUri("data:application/octet-stream;base64,!!!!")), "");
  WriteFile(dir_ / "short.bin", gltf.buffer.substr(1));
  EXPECT_NE(RefusalOf(gltf.WithUri("short.bin")), "");
}

TEST_F(SceneIoHostileTest, ClaimsThatWouldExhaustMemoryAreRefused) {
  const auto with_buffers = [](const json& buffers) {
    json root = Tetrahedron().root;
    root["buffers"] = buffers;
    return root.dump();
  };
  EXPECT_THAT(RefusalOf(with_buffers({{{"byteLength", 2'000'000'000}, {"uri", "x"}}})), HasSubstr("in all"));
  EXPECT_THAT(RefusalOf(with_buffers({{{"byteLength", 0}, {"uri", "x"}}})), HasSubstr("byteLength"));
  EXPECT_THAT(RefusalOf(with_buffers({{{"uri", "x"}}})), HasSubstr("byteLength"));
  EXPECT_THAT(RefusalOf(with_buffers({{{"byteLength", 4}}})), HasSubstr("no uri"));

  EXPECT_THAT(RefusalOf(std::string(2'000'000, '[')), HasSubstr("nested deeper"));
  std::string deep = R"({"asset": {"version": "2.0"}, "extras": )";
  deep += std::string(1'000'000, '[') + std::string(1'000'000, ']') + "}";
  EXPECT_THAT(RefusalOf(deep), HasSubstr("nested deeper"));
  std::string many = R"({"asset": {"version": "2.0"}, "nodes": [{})";
  for (int i = 0; i < 600'000; ++i) many += ",{}";
  EXPECT_THAT(RefusalOf(many + "]}"), HasSubstr("JSON values"));
}

TEST_F(SceneIoHostileTest, AMeshRepeatedWithoutEndIsRefused) {
  GltfBuilder gltf;
  constexpr int kCorners = 3'000'000;
  const int positions = gltf.Positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int indices = gltf.Accessor(std::vector<std::uint8_t>(kCorners, 0), testing::kU8, "SCALAR");
  gltf.Show({{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"mode", 5}});
  for (int i = 0; i < 1000; ++i) {
    gltf.root["scenes"][0]["nodes"].push_back(gltf.Add("nodes", {{"mesh", 0}}));
  }
  EXPECT_THAT(RefusalOf(gltf.Glb(), "scene.glb"), HasSubstr("more than 20000000 triangles"));
}

TEST_F(SceneIoHostileTest, DamagedContainersAreRefused) {
  const std::string glb = Tetrahedron().Glb();
  const auto with_word = [&](std::size_t at, std::uint32_t word) {
    std::string bytes = glb;
    std::memcpy(bytes.data() + at, &word, 4);
    return bytes;
  };
  const auto json_bytes = static_cast<std::uint32_t>(glb.size() - 12 - 8 - 8 - 60);
  EXPECT_EQ(RefusalOf(with_word(12, json_bytes), "scene.glb"), "");  // undamaged
  EXPECT_THAT(RefusalOf(with_word(4, 1), "scene.glb"), HasSubstr("version 1"));
  EXPECT_THAT(RefusalOf(with_word(8, 100), "scene.glb"), HasSubstr("claims 100"));
  EXPECT_NE(RefusalOf(with_word(12, 0xFFFFFFFF), "scene.glb"), "");
  EXPECT_NE(RefusalOf(with_word(12, json_bytes - 4), "scene.glb"), "");
  EXPECT_THAT(RefusalOf(with_word(16, 0), "scene.glb"), HasSubstr("no JSON"));
  // The binary chunk's length: the last 8 bytes of it are where a container's end is easily overrun.
  for (const std::uint32_t length : {0U, 56U, 61U, 64U, 68U, 0xFFFFFFFFU}) {
    EXPECT_NE(RefusalOf(with_word(12 + 8 + json_bytes, length), "scene.glb"), "") << length;
  }
}

TEST_F(SceneIoHostileTest, FilesCutShortAreRefused) {
  for (const std::string& whole : {Tetrahedron().Embedded(), Tetrahedron().Glb()}) {
    for (std::size_t length = 0; length < whole.size(); ++length) {
      EXPECT_NE(RefusalOf(whole.substr(0, length)), "") << length;
    }
  }
}

TEST_F(SceneIoHostileTest, DamagedBytesMakeAValidSceneOrADataError) {
  for (const std::string& whole : {Tetrahedron().Embedded(), Tetrahedron().Glb()}) {
    int refused = 0;
    for (unsigned seed = 1; seed <= 3000; ++seed) {
      std::mt19937 random(seed);
      std::string damaged = whole;
      for (unsigned i = 0; i < 1 + seed % 4; ++i) {
        char& byte = damaged[random() % damaged.size()];
        // Digits for digits half of the time: otherwise most of the damage ends in the JSON parser.
        byte = std::isdigit(static_cast<unsigned char>(byte)) != 0 && seed % 2 == 0
                   ? static_cast<char>('0' + random() % 10)
                   : static_cast<char>(random());
      }
      refused += RefusalOf(damaged).empty() ? 0 : 1;
    }
    EXPECT_GT(refused, 1000);
    EXPECT_LT(refused, 3000);
  }
}

}  // namespace
}  // namespace sonarcal::data_io
