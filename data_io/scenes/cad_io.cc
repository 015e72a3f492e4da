#include "data_io/scenes/cad_io.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/types/error.h"
#include "data_io/files/file_bytes.h"
#include "data_io/scenes/cad_mesh.h"
#include "data_io/scenes/scene_assembler.h"
#include "data_io/scenes/scene_io.h"

namespace sonarcal::data_io {
namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is little-endian");

// Merges vertices at the same position.
class VertexWelder {
 public:
  VertexWelder(SceneAssembler* scene, const Eigen::Matrix3d& world_from_file)
      : scene_(scene), world_from_file_(world_from_file) {}

  std::uint32_t IndexOf(const Eigen::Vector3f& vertex) {
    // Adding 0 makes -0 equal to 0. Bits are compared because NaN is not equal to itself.
    const Key key = {std::bit_cast<std::uint32_t>(vertex.x() + 0.0F),
                     std::bit_cast<std::uint32_t>(vertex.y() + 0.0F),
                     std::bit_cast<std::uint32_t>(vertex.z() + 0.0F)};
    const auto [found, added] = index_.try_emplace(key, static_cast<std::uint32_t>(scene_->vertex_count()));
    if (added) scene_->AddVertex(world_from_file_ * vertex.cast<double>());
    return found->second;
  }

 private:
  using Key = std::array<std::uint32_t, 3>;
  struct Hash {
    std::size_t operator()(const Key& key) const {
      std::uint64_t hash = 0;
      for (const std::uint32_t word : key) hash = (hash ^ word) * 0x9E3779B97F4A7C15ULL + (hash >> 29);
      return hash;
    }
  };

  SceneAssembler* scene_;
  Eigen::Matrix3d world_from_file_;
  std::unordered_map<Key, std::uint32_t, Hash> index_;
};

Eigen::Matrix3d WorldFromFile(const SceneConventions& conventions, UpAxis default_up,
                              const std::string& file) {
  const double scale = conventions.metres_per_unit.value_or(1.0);
  if (!(scale > 0.0 && std::isfinite(scale))) {
    throw DataError("{}: a unit of {} m, expected a positive length", file, scale);
  }
  Eigen::Matrix3d world_from_file = Eigen::Matrix3d::Identity();
  if (conventions.up.value_or(default_up) == UpAxis::kY) {
    world_from_file << 1, 0, 0,  //
        0, 0, -1,                //
        0, 1, 0;
  }
  return scale * world_from_file;
}

Scene SceneOf(const CadMesh& mesh, const Eigen::Matrix3d& world_from_file, const std::string& file) {
  SceneAssembler assembler(file);
  VertexWelder welder(&assembler, world_from_file);
  for (std::size_t material = 0; material < mesh.corners.size(); ++material) {
    std::vector<std::uint32_t> corners;
    for (const Eigen::Vector3f& corner : mesh.corners[material]) corners.push_back(welder.IndexOf(corner));
    assembler.AddTriangles(TriangleMode::kSeparate, corners, {0, assembler.vertex_count()}, false,
                           static_cast<int>(material));
  }
  return assembler.Finish(mesh.materials);
}

std::string LowerExtension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

}  // namespace

bool NeedsConventions(const std::filesystem::path& file) {
  const std::string extension = LowerExtension(file);
  return extension == ".obj" || extension == ".stl" || extension == ".ply";
}

Scene ReadScene(const std::filesystem::path& file, const SceneConventions& conventions) {
  if (!NeedsConventions(file)) {
    if (!conventions.empty()) {
      throw DataError("{}: a unit or an upward axis is given, but a glTF has its own: metres, Y up",
                      file.string());
    }
    return ReadGltf(file);
  }
  const std::string bytes = ReadFileBytes(file, kMaxCadBytes);
  const std::string extension = LowerExtension(file);
  const auto parse = extension == ".obj" ? ParseObj : extension == ".stl" ? ParseStl : ParsePly;
  return parse(bytes, file.string(), conventions);
}

Scene ParseObj(std::string_view bytes, const std::string& file, const SceneConventions& conventions) {
  const Eigen::Matrix3d world_from_file = WorldFromFile(conventions, UpAxis::kY, file);
  return SceneOf(ReadObjMesh(bytes, file), world_from_file, file);
}

Scene ParseStl(std::string_view bytes, const std::string& file, const SceneConventions& conventions) {
  const Eigen::Matrix3d world_from_file = WorldFromFile(conventions, UpAxis::kZ, file);
  return SceneOf(ReadStlMesh(bytes, file), world_from_file, file);
}

Scene ParsePly(std::string_view bytes, const std::string& file, const SceneConventions& conventions) {
  const Eigen::Matrix3d world_from_file = WorldFromFile(conventions, UpAxis::kZ, file);
  return SceneOf(ReadPlyMesh(bytes, file), world_from_file, file);
}

}  // namespace sonarcal::data_io
