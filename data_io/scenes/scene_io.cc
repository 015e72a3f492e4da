#include "data_io/scenes/scene_io.h"

#include <tiny_gltf.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <map>
#include <numeric>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/files/atomic_output.h"
#include "data_io/files/file_bytes.h"
#include "data_io/scenes/gltf_document.h"
#include "data_io/scenes/scene_assembler.h"

namespace sonarcal::data_io {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF buffers are little-endian");

// Sets the callback for the size of a file, which tinygltf has since 2.9. Reading checks the size, so this
// allows any.
template <typename Callbacks>
void AllowAnySize(Callbacks& files) {
  if constexpr (requires { files.GetFileSizeInBytes; }) {
    files.GetFileSizeInBytes = [](std::size_t* size, std::string*, const std::string&, void*) {
      *size = 0;
      return true;
    };
  }
}

// File access of tinygltf for buffers. Exceptions pass through it. tinygltf refuses a set with a callback
// missing.
tinygltf::FsCallbacks FilesBelow(std::filesystem::path* directory) {
  // Every file "exists", so that reading is always attempted and reports the error.
  tinygltf::FsCallbacks files{};
  files.FileExists = [](const std::string&, void*) { return true; };
  files.ExpandFilePath = [](const std::string& uri, void*) { return uri; };
  files.ReadWholeFile = [](std::vector<unsigned char>* bytes, std::string*, const std::string& uri,
                           void* below) {
    const std::string read = ReadGltfBuffer(*static_cast<std::filesystem::path*>(below), uri);
    bytes->assign(read.begin(), read.end());
    return true;
  };
  files.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
    return false;
  };
  AllowAnySize(files);
  files.user_data = directory;
  return files;
}

tinygltf::Model LoadModel(std::string_view bytes, const std::filesystem::path& file) {
  const std::string name = file.string();
  const GltfDocument document = ReduceGltf(bytes, name);
  std::filesystem::path directory = file.parent_path();
  tinygltf::TinyGLTF loader;
  loader.SetFsCallbacks(FilesBelow(&directory));
  tinygltf::Model model;
  std::string error;
  std::string warning;
  const auto size = static_cast<unsigned>(document.bytes.size());
  bool loaded = false;
  try {
    loaded =
        document.binary
            ? loader.LoadBinaryFromMemory(&model, &error, &warning,
                                          reinterpret_cast<const unsigned char*>(document.bytes.data()), size)
            : loader.LoadASCIIFromString(&model, &error, &warning, document.bytes.data(), size, "");
  } catch (const DataError& refused) {
    throw DataError("{}: {}", name, refused.what());
  } catch (const std::exception& thrown) {  // including those of nlohmann::json
    throw DataError("{}: not readable as glTF: {}", name, Printable(thrown.what(), 300));
  }
  if (!loaded) {
    const std::string first_line = error.substr(0, error.find('\n'));
    throw DataError("{}: not readable as glTF: {}", name, Printable(first_line, 300));
  }
  return model;
}

// Elements of an accessor, checked to lie inside their buffer.
struct Elements {
  const unsigned char* first = nullptr;
  std::size_t stride_bytes = 0;
  std::size_t count = 0;

  template <typename T>
  T At(std::size_t i) const {
    T value;
    std::memcpy(&value, first + i * stride_bytes, sizeof(T));
    return value;
  }
};

Eigen::Affine3d WorldFromGltf() {
  Eigen::Affine3d world_from_gltf = Eigen::Affine3d::Identity();
  world_from_gltf.linear() << 1, 0, 0,  //
      0, 0, -1,                         //
      0, 1, 0;
  return world_from_gltf;
}

class SceneBuilder {
 public:
  SceneBuilder(const tinygltf::Model& model, const std::string& file)
      : model_(model), file_(file), scene_(file) {}

  Scene Build() {
    std::vector<Visit> pending;
    const auto push = [&](const std::vector<int>& nodes, const Eigen::Affine3d& transform, int depth) {
      // Last first, so that they are processed in the order of the file.
      for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) {
        pending.push_back({*node, transform, depth});
      }
    };
    // Named nodes whose children are not yet complete. Vertices of a node and its children are consecutive.
    std::vector<OpenNode> open;
    const auto close_to = [&](int depth) {
      for (; !open.empty() && open.back().depth >= depth; open.pop_back())
        scene_.NameObject(open.back().name, open.back().first_vertex);
    };
    std::vector<bool> visited(model_.nodes.size(), false);
    push(RootNodes(), WorldFromGltf(), 1);
    while (!pending.empty()) {
      const Visit visit = pending.back();
      pending.pop_back();
      const tinygltf::Node& node = At(model_.nodes, visit.node, "node");
      if (visited[visit.node]) {
        throw DataError("{}: node {} is reached twice; expected nodes with one parent and no cycle", file_,
                        visit.node);
      }
      visited[visit.node] = true;
      if (visit.depth > kMaxSceneNodeDepth) {
        throw DataError("{}: nodes nested deeper than {} levels", file_, kMaxSceneNodeDepth);
      }
      close_to(visit.depth);
      open.push_back({node.name, scene_.vertex_count(), visit.depth});
      const Eigen::Affine3d world_from_node = visit.world_from_parent * ParentFromNode(node, visit.node);
      if (node.mesh >= 0) AddMesh(At(model_.meshes, node.mesh, "mesh"), world_from_node);
      push(node.children, world_from_node, visit.depth + 1);
    }
    close_to(0);
    std::vector<std::string> names;
    for (const tinygltf::Material& material : model_.materials) names.push_back(material.name);
    return scene_.Finish(names);
  }

 private:
  struct Visit {
    int node;
    Eigen::Affine3d world_from_parent;
    int depth;
  };
  struct OpenNode {
    std::string name;
    std::size_t first_vertex;
    int depth;
  };

  template <typename T>
  const T& At(const std::vector<T>& items, int index, const char* what) const {
    if (index < 0 || static_cast<std::size_t>(index) >= items.size()) {
      throw DataError("{}: {} {} is named, but there are {}", file_, what, index, items.size());
    }
    return items[index];
  }

  std::vector<int> RootNodes() const {
    if (!model_.scenes.empty()) {
      return At(model_.scenes, std::max(model_.defaultScene, 0), "scene").nodes;
    }
    std::vector<bool> is_child(model_.nodes.size(), false);
    for (const tinygltf::Node& node : model_.nodes) {
      for (const int child : node.children) {
        At(model_.nodes, child, "node");
        is_child[child] = true;
      }
    }
    std::vector<int> roots;
    for (std::size_t i = 0; i < is_child.size(); ++i) {
      if (!is_child[i]) roots.push_back(static_cast<int>(i));
    }
    return roots;
  }

  Eigen::Affine3d ParentFromNode(const tinygltf::Node& node, int index) const {
    Eigen::Affine3d transform = Eigen::Affine3d::Identity();
    if (node.matrix.size() == 16) {
      const Eigen::Map<const Eigen::Matrix4d> matrix(node.matrix.data());  // column-major, as in glTF
      if (matrix.row(3) != Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)) {
        throw DataError("{}: the matrix of node {} does not end in a row 0 0 0 1", file_, index);
      }
      transform.matrix() = matrix;
    } else {
      if (node.translation.size() == 3) {
        transform.translate(Eigen::Map<const Eigen::Vector3d>(node.translation.data()));
      }
      if (node.rotation.size() == 4) {
        const Eigen::Map<const Eigen::Quaterniond> rotation(node.rotation.data());  // x, y, z, w in both
        if (!(rotation.norm() > 1e-6)) {
          throw DataError("{}: the rotation of node {} has no length, expected a unit quaternion", file_,
                          index);
        }
        transform.rotate(rotation.normalized());
      }
      if (node.scale.size() == 3) transform.scale(Eigen::Map<const Eigen::Vector3d>(node.scale.data()));
    }
    return transform;
  }

  void AddMesh(const tinygltf::Mesh& mesh, const Eigen::Affine3d& world_from_node) {
    std::map<int, VertexRange> vertices_of;  // primitives with the same positions share vertices
    const bool mirrored = world_from_node.linear().determinant() < 0.0;
    for (const tinygltf::Primitive& primitive : mesh.primitives) {
      const auto position = primitive.attributes.find("POSITION");
      const int accessor = position == primitive.attributes.end() ? -1 : position->second;
      const Elements positions =
          Resolve(accessor, TINYGLTF_TYPE_VEC3, {TINYGLTF_COMPONENT_TYPE_FLOAT}, "32-bit float VEC3");
      const auto [found, added] =
          vertices_of.try_emplace(accessor, VertexRange{scene_.vertex_count(), positions.count});
      if (added) {
        for (std::size_t i = 0; i < positions.count; ++i) {
          const Eigen::Vector3f vertex_m(positions.At<std::array<float, 3>>(i).data());
          scene_.AddVertex(world_from_node * vertex_m.cast<double>());
        }
      }
      scene_.AddTriangles(ModeOf(primitive), Corners(primitive, positions.count), found->second, mirrored,
                          primitive.material);
    }
  }

  TriangleMode ModeOf(const tinygltf::Primitive& primitive) const {
    switch (primitive.mode) {
      case TINYGLTF_MODE_TRIANGLES:
        return TriangleMode::kSeparate;
      case TINYGLTF_MODE_TRIANGLE_STRIP:
        return TriangleMode::kStrip;
      case TINYGLTF_MODE_TRIANGLE_FAN:
        return TriangleMode::kFan;
      default:
        throw DataError("{}: a primitive of mode {}, expected triangles (4), a strip (5) or a fan (6)", file_,
                        primitive.mode);
    }
  }

  // Checks that an accessor has the required type and lies inside its buffer, which tinygltf does not check.
  Elements Resolve(int index, int type, std::initializer_list<int> component_types,
                   const char* expected) const {
    const tinygltf::Accessor& accessor = At(model_.accessors, index, "accessor");
    const bool known = std::find(component_types.begin(), component_types.end(), accessor.componentType) !=
                       component_types.end();
    if (accessor.type != type || !known || accessor.normalized) {
      throw DataError("{}: accessor {} holds something else than {} values, not normalized", file_, index,
                      expected);
    }
    if (accessor.bufferView < 0) {
      throw DataError("{}: accessor {} has no buffer view, as in compressed files", file_, index);
    }
    const tinygltf::BufferView& view = At(model_.bufferViews, accessor.bufferView, "buffer view");
    const std::vector<unsigned char>& bytes = At(model_.buffers, view.buffer, "buffer").data;
    if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset) {
      throw DataError("{}: buffer view {} ends beyond its buffer of {} bytes", file_, accessor.bufferView,
                      bytes.size());
    }
    const std::size_t element_bytes =
        static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(accessor.componentType)) *
        tinygltf::GetNumComponentsInType(type);
    const std::size_t stride_bytes = view.byteStride == 0 ? element_bytes : view.byteStride;
    if (stride_bytes < element_bytes) {
      throw DataError("{}: buffer view {} has a stride of {} bytes for elements of {}", file_,
                      accessor.bufferView, stride_bytes, element_bytes);
    }
    const std::size_t after_offset = view.byteLength - std::min(accessor.byteOffset, view.byteLength);
    const std::size_t fitting =
        after_offset < element_bytes ? 0 : (after_offset - element_bytes) / stride_bytes + 1;
    if (accessor.count < 1 || accessor.count > fitting) {
      throw DataError(
          "{}: accessor {} claims {} elements, expected 1 to {}, which is what its buffer view holds", file_,
          index, accessor.count, fitting);
    }
    return {bytes.data() + view.byteOffset + accessor.byteOffset, stride_bytes, accessor.count};
  }

  // Vertices of a primitive in order; all of them if it has no indices.
  std::vector<std::uint32_t> Corners(const tinygltf::Primitive& primitive, std::size_t vertex_count) const {
    std::vector<std::uint32_t> corners;
    if (primitive.indices < 0) {
      corners.resize(vertex_count);
      std::iota(corners.begin(), corners.end(), 0U);
      return corners;
    }
    const Elements indices =
        Resolve(primitive.indices, TINYGLTF_TYPE_SCALAR,
                {TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT,
                 TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT},
                "8-, 16- or 32-bit unsigned scalar");
    if (indices.count > 3 * kMaxSceneTriangles) {
      throw DataError("{}: accessor {} makes more than {} triangles", file_, primitive.indices,
                      kMaxSceneTriangles);
    }
    const int component = model_.accessors[primitive.indices].componentType;
    corners.reserve(indices.count);
    for (std::size_t i = 0; i < indices.count; ++i) {
      corners.push_back(component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE    ? indices.At<std::uint8_t>(i)
                        : component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ? indices.At<std::uint16_t>(i)
                                                                              : indices.At<std::uint32_t>(i));
    }
    return corners;
  }

  const tinygltf::Model& model_;
  std::string file_;
  SceneAssembler scene_;
};

// Appends values to the only buffer, in a new buffer view. Returns the index of a new accessor.
template <typename T>
int AppendAccessor(tinygltf::Model* model, const std::vector<T>& values, std::size_t count, int type,
                   int component_type, int target) {
  std::vector<unsigned char>& bytes = model->buffers[0].data;
  tinygltf::BufferView view;
  view.buffer = 0;
  view.byteOffset = bytes.size();
  view.byteLength = values.size() * sizeof(T);
  view.target = target;
  const auto* first = reinterpret_cast<const unsigned char*>(values.data());
  bytes.insert(bytes.end(), first, first + view.byteLength);

  tinygltf::Accessor accessor;
  accessor.bufferView = static_cast<int>(model->bufferViews.size());
  accessor.count = count;
  accessor.type = type;
  accessor.componentType = component_type;
  model->bufferViews.push_back(std::move(view));
  model->accessors.push_back(std::move(accessor));
  return static_cast<int>(model->accessors.size()) - 1;
}

int AppendPositions(tinygltf::Model* model, const Scene& scene) {
  std::vector<float> coordinates;
  Eigen::AlignedBox3f bounds;
  for (const Eigen::Vector3f& world_m : scene.vertices_m) {
    const Eigen::Vector3f gltf_m(world_m.x(), world_m.z(), -world_m.y());
    bounds.extend(gltf_m);
    coordinates.insert(coordinates.end(), gltf_m.begin(), gltf_m.end());
  }
  const int index = AppendAccessor(model, coordinates, scene.vertices_m.size(), TINYGLTF_TYPE_VEC3,
                                   TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TARGET_ARRAY_BUFFER);
  model->accessors[index].minValues.assign(bounds.min().begin(), bounds.min().end());
  model->accessors[index].maxValues.assign(bounds.max().begin(), bounds.max().end());
  return index;
}

tinygltf::Model ModelOf(const Scene& scene) {
  tinygltf::Model model;
  model.asset.version = "2.0";
  model.asset.generator = "sonarcal";
  model.buffers.emplace_back();
  const int positions = AppendPositions(&model, scene);

  std::vector<std::vector<std::uint32_t>> corners(scene.material_names.size());
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    std::vector<std::uint32_t>& of_material = corners[scene.triangle_material[i]];
    of_material.insert(of_material.end(), scene.triangles[i].begin(), scene.triangles[i].end());
  }
  tinygltf::Mesh mesh;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (corners[i].empty()) continue;
    tinygltf::Primitive primitive;
    primitive.attributes["POSITION"] = positions;
    primitive.indices =
        AppendAccessor(&model, corners[i], corners[i].size(), TINYGLTF_TYPE_SCALAR,
                       TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.material = static_cast<int>(model.materials.size());
    tinygltf::Material material;
    material.name = scene.material_names[i];
    model.materials.push_back(std::move(material));
    mesh.primitives.push_back(std::move(primitive));
  }
  model.meshes.push_back(std::move(mesh));
  model.nodes.emplace_back().mesh = 0;
  model.scenes.emplace_back().nodes = {0};
  model.defaultScene = 0;
  return model;
}

}  // namespace

Scene ReadGltf(const std::filesystem::path& file) {
  return ParseGltf(ReadFileBytes(file, kMaxGltfBytes), file);
}

Scene ParseGltf(std::string_view bytes, const std::filesystem::path& file) {
  const tinygltf::Model model = LoadModel(bytes, file);
  return SceneBuilder(model, file.string()).Build();
}

void WriteGltf(const Scene& scene, const std::filesystem::path& file) {
  const bool binary = file.extension() == ".glb";
  if (!binary && file.extension() != ".gltf") {
    throw DataError("{}: expected a name that ends in .gltf or .glb", file.string());
  }
  scene.Validate(file.string());
  if (scene.vertices_m.size() > kMaxSceneVertices || scene.triangles.size() > kMaxSceneTriangles) {
    throw DataError("{}: a scene of {} vertices and {} triangles, expected at most {} and {}", file.string(),
                    scene.vertices_m.size(), scene.triangles.size(), kMaxSceneVertices, kMaxSceneTriangles);
  }
  const tinygltf::Model model = ModelOf(scene);
  std::ostringstream stream;
  try {
    tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, stream, /*prettyPrint=*/true, binary);
  } catch (const std::exception& error) {
    throw DataError("{}: cannot be written as glTF: {}", file.string(), Printable(error.what(), 300));
  }
  WriteFileWhole(file, stream.str());
}

}  // namespace sonarcal::data_io
