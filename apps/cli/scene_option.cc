#include "apps/cli/scene_option.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/choice_option.h"
#include "core/types/error.h"

namespace sonarcal::cli {
namespace {}  // namespace

double MetresPerUnit(LengthUnit unit) {
  switch (unit) {
    case LengthUnit::kMetre:
      return 1.0;
    case LengthUnit::kCentimetre:
      return 0.01;
    case LengthUnit::kMillimetre:
      return 0.001;
    case LengthUnit::kInch:
      return 0.0254;
    case LengthUnit::kFoot:
      return 0.3048;
  }
  return 1.0;
}

void AddSceneOptions(CLI::App& command, std::filesystem::path& scene, SceneFormat& format,
                     const std::string& description, bool required, const std::string& name) {
  command.add_option(name, scene, description)->type_name("GLTF|OBJ|STL|PLY")->required(required);
  AddChoice(command, "--scene-unit", format.unit, "Unit of an OBJ, STL or PLY scene (default: m)");
  AddChoice(command, "--scene-up", format.up,
            "Upward axis of an OBJ, STL or PLY scene (default: y for OBJ, z for STL and PLY)");
}

Scene ReadSceneFile(const std::filesystem::path& scene, const SceneFormat& format,
                    const CommonOptions& common) {
  if (!data_io::NeedsConventions(scene)) {
    if (format.unit || format.up) {
      throw UsageError(
          "--scene-unit and --scene-up are for OBJ, STL and PLY; {} is read as glTF, which is in metres and "
          "Y up",
          scene.string());
    }
    return data_io::ReadScene(scene);
  }
  data_io::SceneConventions conventions{.metres_per_unit = {}, .up = format.up};
  if (format.unit) conventions.metres_per_unit = MetresPerUnit(*format.unit);
  Scene read = data_io::ReadScene(scene, conventions);
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex_m : read.vertices_m) box.extend(vertex_m);
  const Eigen::Vector3f size_m = box.sizes();
  PrintNote(common, fmt::format("{}: {} triangles, {:.4g} x {:.4g} m and {:.4g} m high; its format states "
                                "neither unit nor upward axis, set them with --scene-unit and --scene-up",
                                scene.string(), read.triangles.size(), size_m.x(), size_m.y(), size_m.z()));
  return read;
}

nlohmann::ordered_json SceneFormatJson(const SceneFormat& format) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  if (format.unit) json["scene_unit"] = ToString(*format.unit);
  if (format.up) json["scene_up"] = ToString(*format.up);
  return json;
}

}  // namespace sonarcal::cli
