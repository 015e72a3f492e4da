#include "data_io/scenes/cad_io.h"

#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

#include <assimp/Importer.hpp>

#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/files/file_bytes.h"
#include "data_io/scenes/obj_document.h"
#include "data_io/scenes/scene_assembler.h"
#include "data_io/scenes/scene_io.h"
#include "data_io/scenes/stl_document.h"

namespace sonarcal::data_io {
namespace {

static_assert(std::endian::native == std::endian::little, "binary STL is little-endian");

// Merges vertices at the same position: STL repeats each one per triangle, and so does assimp for OBJ.
class VertexWelder {
 public:
  VertexWelder(SceneAssembler* scene, const Eigen::Matrix3d& world_from_file)
      : scene_(scene), world_from_file_(world_from_file) {}

  std::uint32_t IndexOf(const aiVector3D& vertex) {
    // Adding 0 makes -0 equal to 0. Bits are compared because NaN is not equal to itself.
    const Key key = {std::bit_cast<std::uint32_t>(vertex.x + 0.0F),
                     std::bit_cast<std::uint32_t>(vertex.y + 0.0F),
                     std::bit_cast<std::uint32_t>(vertex.z + 0.0F)};
    const auto [found, added] = index_.try_emplace(key, static_cast<std::uint32_t>(scene_->vertex_count()));
    if (added) scene_->AddVertex(world_from_file_ * Eigen::Vector3d(vertex.x, vertex.y, vertex.z));
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

// `hint` is the format's extension, by which assimp selects its reader.
std::unique_ptr<Assimp::Importer> Import(const std::string& bytes, const char* hint,
                                         const std::string& file) {
  auto importer = std::make_unique<Assimp::Importer>();
  const aiScene* scene = nullptr;
  try {
    scene = importer->ReadFileFromMemory(bytes.data(), bytes.size(), /*pFlags=*/0, hint);
  } catch (const std::exception& error) {
    throw DataError("{}: not readable as {}: {}", file, hint, Printable(error.what(), 300));
  }
  if (scene == nullptr) {
    throw DataError("{}: not readable as {}: {}", file, hint, Printable(importer->GetErrorString(), 300));
  }
  return importer;
}

// Number that a reduced OBJ has as a material's name; -1 for a material that assimp added.
int MaterialNumber(const aiScene& imported, const aiMesh& mesh, std::size_t count) {
  if (mesh.mMaterialIndex >= imported.mNumMaterials) return -1;
  aiString name;
  if (imported.mMaterials[mesh.mMaterialIndex]->Get(AI_MATKEY_NAME, name) != AI_SUCCESS) return -1;
  int number = -1;
  const auto [end, error] = std::from_chars(name.data, name.data + name.length, number);
  const bool whole = error == std::errc() && end == name.data + name.length;
  return whole && number >= 0 && static_cast<std::size_t>(number) < count ? number : -1;
}

// Triangles of all meshes. Materials are those of `names`; none if it is empty.
Scene Assemble(const aiScene& imported, const Eigen::Matrix3d& world_from_file,
               const std::vector<std::string>& names, std::size_t triangles_expected,
               const std::string& file) {
  SceneAssembler assembler(file);
  VertexWelder welder(&assembler, world_from_file);
  std::size_t triangles = 0;
  for (unsigned m = 0; m < imported.mNumMeshes; ++m) {
    const aiMesh& mesh = *imported.mMeshes[m];
    std::vector<std::uint32_t> corners;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;
      ++triangles;
      for (unsigned k = 0; k < 3; ++k) {
        if (face.mIndices[k] >= mesh.mNumVertices) {
          throw DataError("{}: a triangle names vertex {} of {}", file, face.mIndices[k], mesh.mNumVertices);
        }
        corners.push_back(welder.IndexOf(mesh.mVertices[face.mIndices[k]]));
      }
    }
    if (corners.empty()) continue;
    assembler.AddTriangles(TriangleMode::kSeparate, corners, {0, assembler.vertex_count()}, false,
                           MaterialNumber(imported, mesh, names.size()));
  }
  if (triangles != triangles_expected) {
    throw DataError("{}: {} triangles were read of {}", file, triangles, triangles_expected);
  }
  return assembler.Finish(names);
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
  return extension == ".obj" || extension == ".stl";
}

Scene ReadScene(const std::filesystem::path& file, const SceneConventions& conventions) {
  if (!NeedsConventions(file)) {
    if (!conventions.empty()) {
      throw DataError("{}: a unit or an upward axis is given, but a glTF has its own: metres, Y up",
                      file.string());
    }
    return ReadGltf(file);
  }
  std::string bytes = ReadFileBytes(file, kMaxCadBytes);
  return LowerExtension(file) == ".obj" ? ParseObj(std::move(bytes), file.string(), conventions)
                                        : ParseStl(std::move(bytes), file.string(), conventions);
}

Scene ParseObj(std::string bytes, const std::string& file, const SceneConventions& conventions) {
  const Eigen::Matrix3d world_from_file = WorldFromFile(conventions, UpAxis::kY, file);
  ObjDocument document = ReduceObj(bytes, file);
  bytes = {};
  const auto importer = Import(document.text, "obj", file);
  document.text = {};
  return Assemble(*importer->GetScene(), world_from_file, document.materials, document.triangles, file);
}

Scene ParseStl(std::string bytes, const std::string& file, const SceneConventions& conventions) {
  const Eigen::Matrix3d world_from_file = WorldFromFile(conventions, UpAxis::kZ, file);
  const StlDocument document = CheckStl(std::move(bytes), file);
  const auto importer = Import(document.bytes, "stl", file);
  return Assemble(*importer->GetScene(), world_from_file, {}, document.triangles, file);
}

}  // namespace sonarcal::data_io
