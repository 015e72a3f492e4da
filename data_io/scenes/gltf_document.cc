#include "data_io/scenes/gltf_document.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <span>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/types/error.h"
#include "core/types/parameters.h"
#include "core/types/printable.h"
#include "data_io/files/byte_reader.h"
#include "data_io/files/file_bytes.h"
#include "data_io/json/json_document.h"

namespace sonarcal::data_io {
namespace {

// Unlike nlohmann::ordered_json, reads an object of very many members fast.
using SortedJson = nlohmann::json;

constexpr std::uint32_t kGlbMagic = 0x46546C67;   // "glTF"
constexpr std::uint32_t kJsonChunk = 0x4E4F534A;  // "JSON"
constexpr std::uint32_t kBinChunk = 0x004E4942;   // "BIN"
constexpr std::size_t kGlbHeaderBytes = 12;
constexpr std::size_t kChunkHeaderBytes = 8;

// JSON and binary part of a file; `bin` is empty if there is no binary chunk.
struct Parts {
  bool binary = false;
  std::string_view json;
  std::string_view bin;
};

Parts SplitGlb(std::string_view bytes, const std::string& file) {
  const ByteReader reader(std::as_bytes(std::span(bytes)), file);
  const std::uint32_t version = reader.U32(4, "version");
  if (version != 2) throw DataError("{}: glTF version {}, expected 2", file, version);
  const std::uint32_t length = reader.U32(8, "length");
  if (length != bytes.size()) {
    throw DataError("{}: a file of {} bytes whose header claims {}", file, bytes.size(), length);
  }
  Parts parts{.binary = true, .json = {}, .bin = {}};
  std::uint64_t at = kGlbHeaderBytes;
  for (int chunk = 0; at < bytes.size(); ++chunk) {
    const std::uint32_t chunk_bytes = reader.U32(at, "length of a chunk");
    const std::uint32_t type = reader.U32(at + 4, "type of a chunk");
    reader.Bytes(at + kChunkHeaderBytes, chunk_bytes, "chunk");  // rejects a chunk beyond the end of the file
    const std::string_view content = bytes.substr(at + kChunkHeaderBytes, chunk_bytes);
    if (chunk == 0 && type == kJsonChunk) parts.json = content;
    if (chunk == 1 && type == kBinChunk) parts.bin = content;  // chunks of other types are ignored
    at += kChunkHeaderBytes + chunk_bytes;
  }
  if (parts.json.empty()) throw DataError("{}: no JSON in its first chunk", file);
  return parts;
}

Parts Split(std::string_view bytes, const std::string& file) {
  const bool binary =
      bytes.size() >= kGlbHeaderBytes && LittleEndian(std::as_bytes(std::span(bytes).first(4))) == kGlbMagic;
  return binary ? SplitGlb(bytes, file) : Parts{.binary = false, .json = bytes, .bin = {}};
}

// Checks nesting and number of values before a tree is built.
void CheckJsonSize(std::string_view text, const std::string& file) {
  const JsonSize size = SizeOfJson(text);
  if (size.depth > kMaxGltfJsonDepth)
    throw DataError("{}: JSON nested deeper than {} levels", file, kMaxGltfJsonDepth);
  if (size.values > kMaxGltfJsonValues)
    throw DataError("{}: more than {} JSON values", file, kMaxGltfJsonValues);
}

SortedJson Parse(std::string_view text, const std::string& file) {
  CheckNoTextBehindNul(text, file);
  CheckJsonSize(text, file);
  try {
    return SortedJson::parse(text);
  } catch (const SortedJson::exception& error) {
    // In "[json.exception.parse_error.101] parse error at line 1, column 2: ...", the first word is removed.
    const std::string_view what = error.what();
    throw DataError("{}: not readable as JSON: {}", file, Printable(what.substr(what.find(' ') + 1), 200));
  }
}

// Path of a member in the JSON, for messages: "nodes[3].mesh".
std::string Where(const std::string& owner, const char* member) {
  return owner.empty() ? member : owner + "." + member;
}

bool IsIndex(const SortedJson& value) {
  return value.is_number_unsigned() &&
         value.get<std::uint64_t>() <= static_cast<std::uint64_t>(std::numeric_limits<int>::max());
}

void CheckIndices(const SortedJson& object, const std::string& owner, const std::string& file,
                  std::initializer_list<const char*> members) {
  for (const char* member : members) {
    const auto found = object.find(member);
    if (found != object.end() && !IsIndex(*found)) {
      throw DataError("{}: {} is {}, expected a whole number from 0 to {}", file, Where(owner, member),
                      Printable(found->dump(-1, ' ', true, SortedJson::error_handler_t::replace), 40),
                      std::numeric_limits<int>::max());
    }
  }
}

void CheckIndexArray(const SortedJson& object, const std::string& owner, const std::string& file,
                     const char* member) {
  const auto found = object.find(member);
  if (found == object.end()) return;
  if (!found->is_array() || !std::all_of(found->begin(), found->end(), IsIndex)) {
    throw DataError("{}: {} is not an array of whole numbers", file, Where(owner, member));
  }
}

void CheckNumbers(const SortedJson& object, const std::string& owner, const std::string& file,
                  const char* member, std::size_t count) {
  const auto found = object.find(member);
  if (found == object.end()) return;
  const auto is_number = [](const SortedJson& value) { return value.is_number(); };
  if (!found->is_array() || found->size() != count || !std::all_of(found->begin(), found->end(), is_number)) {
    throw DataError("{}: {} is not an array of {} numbers", file, Where(owner, member), count);
  }
}

// Calls `check(object, "nodes[3]")` for each object of an array that may be absent, and removes members that
// are not read.
template <typename Check>
void ForEachObject(SortedJson& object, const std::string& owner, const std::string& file, const char* member,
                   const Check& check) {
  const auto found = object.find(member);
  if (found == object.end()) return;
  const std::string name = Where(owner, member);
  if (!found->is_array()) throw DataError("{}: {} is not an array", file, name);
  for (std::size_t i = 0; i < found->size(); ++i) {
    const std::string where = name + "[" + std::to_string(i) + "]";
    if (!(*found)[i].is_object()) throw DataError("{}: {} is not an object", file, where);
    (*found)[i].erase("extras");
    (*found)[i].erase("extensions");
    check((*found)[i], where);
  }
}

void CheckPrimitive(const SortedJson& primitive, const std::string& where, const std::string& file) {
  CheckIndices(primitive, where, file, {"mode", "indices", "material"});
  const auto attributes = primitive.find("attributes");
  if (attributes == primitive.end() || !attributes->is_object() || !attributes->contains("POSITION") ||
      !std::all_of(attributes->begin(), attributes->end(), IsIndex)) {
    throw DataError("{}: {} has no attributes with a POSITION", file, where);
  }
}

void CheckGeometry(SortedJson& root, const std::string& file) {
  CheckIndices(root, "", file, {"scene"});
  ForEachObject(root, "", file, "scenes", [&](const SortedJson& scene, const std::string& where) {
    CheckIndexArray(scene, where, file, "nodes");
  });
  ForEachObject(root, "", file, "nodes", [&](const SortedJson& node, const std::string& where) {
    CheckIndices(node, where, file, {"mesh"});
    CheckIndexArray(node, where, file, "children");
    CheckNumbers(node, where, file, "matrix", 16);
    CheckNumbers(node, where, file, "translation", 3);
    CheckNumbers(node, where, file, "rotation", 4);
    CheckNumbers(node, where, file, "scale", 3);
  });
  ForEachObject(root, "", file, "meshes", [&](SortedJson& mesh, const std::string& where) {
    ForEachObject(mesh, where, file, "primitives", [&](const SortedJson& primitive, const std::string& at) {
      CheckPrimitive(primitive, at, file);
    });
  });
  ForEachObject(root, "", file, "accessors", [&](const SortedJson& accessor, const std::string& where) {
    CheckIndices(accessor, where, file, {"bufferView", "byteOffset", "componentType", "count"});
    if (accessor.contains("sparse")) {
      throw DataError("{}: {} is sparse, which is not supported: write it out in full", file, where);
    }
  });
  ForEachObject(root, "", file, "bufferViews", [&](const SortedJson& view, const std::string& where) {
    CheckIndices(view, where, file, {"buffer", "byteOffset", "byteLength", "byteStride"});
  });
}

// In a .glb, only the first buffer may lie in the binary chunk.
void CheckBuffers(SortedJson& root, const Parts& parts, const std::string& file) {
  std::uint64_t total_bytes = 0;
  bool may_be_chunk = parts.binary;
  ForEachObject(root, "", file, "buffers", [&](const SortedJson& buffer, const std::string& where) {
    CheckIndices(buffer, where, file, {"byteLength"});
    const auto length = buffer.find("byteLength");
    const std::uint64_t bytes = length == buffer.end() ? 0 : length->get<std::uint64_t>();
    if (bytes == 0) throw DataError("{}: {} has no byteLength, or one of 0", file, where);
    const auto uri = buffer.find("uri");
    if (uri == buffer.end()) {
      if (!may_be_chunk) throw DataError("{}: {} has no uri", file, where);
      if (bytes > parts.bin.size()) {
        throw DataError("{}: {} claims {} bytes of a binary chunk of {}", file, where, bytes,
                        parts.bin.size());
      }
    } else if (!uri->is_string() || uri->get_ref<const std::string&>().empty()) {
      throw DataError("{}: {}.uri is not a text", file, where);
    }
    may_be_chunk = false;
    total_bytes += bytes;
    if (total_bytes > kMaxGltfBytes) {
      throw DataError("{}: buffers of more than {} bytes in all", file, kMaxGltfBytes);
    }
  });
}

void CheckVersion(const SortedJson& root, const std::string& file) {
  const SortedJson::json_pointer pointer("/asset/version");
  const bool present = root.is_object() && root.contains(pointer) && root.at(pointer).is_string();
  if (!present) throw DataError("{}: no asset.version among its members, expected glTF 2.0", file);
  const auto& version = root.at(pointer).get_ref<const std::string&>();
  if (!version.starts_with("2.")) {
    throw DataError("{}: glTF version {}, expected 2.0", file, Printable(version));
  }
}

// Extensions of a material's appearance do not change the geometry.
void CheckExtensions(const SortedJson& root, const std::string& file) {
  const auto required = root.find("extensionsRequired");
  if (required == root.end()) return;
  if (!required->is_array()) throw DataError("{}: extensionsRequired is not an array", file);
  for (const SortedJson& extension : *required) {
    const std::string name = extension.is_string() ? extension.get<std::string>() : "?";
    const bool harmless = name.starts_with("KHR_materials_") || name.starts_with("KHR_texture_") ||
                          name.starts_with("EXT_texture_") || name == "KHR_lights_punctual";
    if (!harmless) {
      throw DataError(
          "{}: requires the extension {}, which is not supported: export plain glTF 2.0, neither "
          "compressed nor quantized",
          file, Printable(name));
    }
  }
}

void KeepWhatAMeshNeeds(SortedJson* root) {
  SortedJson reduced = {{"asset", {{"version", "2.0"}}}};
  for (const char* member :
       {"scene", "scenes", "nodes", "meshes", "accessors", "bufferViews", "buffers", "materials"}) {
    if (const auto found = root->find(member); found != root->end()) reduced[member] = std::move(*found);
  }
  *root = std::move(reduced);
}

void KeepMaterialNames(SortedJson& root, const std::string& file) {
  std::size_t count = 0;
  ForEachObject(root, "", file, "materials", [&](SortedJson& material, const std::string& where) {
    if (++count > kMaxMaterials) {
      throw DataError("{}: more than {} materials", file, kMaxMaterials);
    }
    SortedJson reduced = SortedJson::object();
    if (const auto name = material.find("name"); name != material.end()) {
      if (!name->is_string()) throw DataError("{}: {}.name is not a text", file, where);
      reduced["name"] = *name;
    }
    material = std::move(reduced);
  });
}

void AppendU32(std::string* bytes, std::size_t value) {
  for (int shift = 0; shift < 32; shift += 8) bytes->push_back(static_cast<char>(value >> shift & 0xFF));
}

std::string JoinGlb(std::string json, std::string_view bin) {
  json.append((4 - json.size() % 4) % 4, ' ');
  const std::size_t padding = (4 - bin.size() % 4) % 4;
  const std::size_t bin_bytes = bin.empty() ? 0 : kChunkHeaderBytes + bin.size() + padding;
  const std::size_t total_bytes = kGlbHeaderBytes + kChunkHeaderBytes + json.size() + bin_bytes;
  std::string glb;
  glb.reserve(total_bytes);
  AppendU32(&glb, kGlbMagic);
  AppendU32(&glb, 2);
  AppendU32(&glb, total_bytes);
  AppendU32(&glb, json.size());
  AppendU32(&glb, kJsonChunk);
  glb += json;
  if (!bin.empty()) {
    AppendU32(&glb, bin.size() + padding);
    AppendU32(&glb, kBinChunk);
    glb += bin;
    glb.append(padding, '\0');
  }
  return glb;
}

}  // namespace

GltfDocument ReduceGltf(std::string_view bytes, const std::string& file) {
  if (bytes.size() > kMaxGltfBytes) {
    throw DataError("{}: {} bytes, expected at most {}", file, bytes.size(), kMaxGltfBytes);
  }
  const Parts parts = Split(bytes, file);
  SortedJson root = Parse(parts.json, file);
  CheckVersion(root, file);
  CheckExtensions(root, file);
  KeepWhatAMeshNeeds(&root);
  KeepMaterialNames(root, file);
  CheckGeometry(root, file);
  CheckBuffers(root, parts, file);

  std::string json = root.dump();
  if (!parts.binary) return {.binary = false, .bytes = std::move(json)};
  return {.binary = true, .bytes = JoinGlb(std::move(json), parts.bin)};
}

std::string ReadGltfBuffer(const std::filesystem::path& directory, const std::string& uri) {
  const std::filesystem::path relative(uri);
  const bool climbs = std::find(relative.begin(), relative.end(), "..") != relative.end();
  if (relative.is_absolute() || climbs || uri.find('\0') != std::string::npos) {
    throw DataError("the buffer {} is outside the file's own directory, which is not allowed",
                    Printable(uri));
  }
  return ReadFileBytes(directory / relative, kMaxGltfBytes);
}

}  // namespace sonarcal::data_io
