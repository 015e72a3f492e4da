#include "apps/export/sdf_world.h"

#include <fmt/format.h>

#include <sstream>

#include <pugixml.hpp>

#include "apps/export/scene_parts.h"
#include "apps/export/xml_text.h"

namespace sonarcal::exporting {
namespace {

pugi::xml_node AddPlugin(pugi::xml_node world, const WorldPlugin& plugin) {
  pugi::xml_node node = world.append_child("plugin");
  node.append_attribute("filename") = plugin.filename;
  node.append_attribute("name") = plugin.name;
  return node;
}

// Lights nothing that a sonar sees. It shows the scene to the user.
void AddSun(pugi::xml_node world) {
  pugi::xml_node light = world.append_child("light");
  light.append_attribute("type") = "directional";
  light.append_attribute("name") = "sun";
  AddElement(light, "pose", "0 0 10 0 0 0");
  AddElement(light, "direction", "-0.5 0.1 -0.9");
}

void AddScenePart(pugi::xml_node world, const std::string& part_name, const std::string& mesh_file) {
  pugi::xml_node model = world.append_child("model");
  model.append_attribute("name") = ("scene_" + part_name).c_str();
  AddElement(model, "static", "true");
  pugi::xml_node link = model.append_child("link");
  link.append_attribute("name") = "link";
  pugi::xml_node visual = link.append_child("visual");
  visual.append_attribute("name") = "visual";
  AddElement(visual.append_child("geometry").append_child("mesh"), "uri", mesh_file);
}

}  // namespace

std::vector<ExportedFile> SdfWorld(const pugi::xml_node& model, const ExportSource& source,
                                   const std::string& name, const std::string& schema,
                                   const std::vector<WorldPlugin>& plugins) {
  const pugi::xml_node root = model.parent();
  pugi::xml_document document;
  document.append_child(pugi::node_declaration).append_attribute("version") = "1.0";
  document.append_child(pugi::node_comment)
      .set_value(XmlComment(fmt::format("\n  Written by sonarcal export, for {}.\n"
                                        "  Start it with: gz sim {}{}\n",
                                        schema, name, kWorldSuffix))
                     .c_str());
  pugi::xml_node sdf = document.append_child("sdf");
  for (const pugi::xml_attribute& attribute : root.attributes()) sdf.append_copy(attribute);
  pugi::xml_node world = sdf.append_child("world");
  world.append_attribute("name") = (name + "_world").c_str();
  AddPlugin(world, {"gz-sim-physics-system", "gz::sim::systems::Physics"});
  AddElement(AddPlugin(world, {"gz-sim-sensors-system", "gz::sim::systems::Sensors"}), "render_engine",
             "ogre2");
  AddPlugin(world, {"gz-sim-user-commands-system", "gz::sim::systems::UserCommands"});
  AddPlugin(world, {"gz-sim-scene-broadcaster-system", "gz::sim::systems::SceneBroadcaster"});
  for (const WorldPlugin& plugin : plugins) AddPlugin(world, plugin);
  AddSun(world);

  // Gazebo's sensors look along X, with Y to the left. The sonar looks along Y.
  const Pose pose = SonarPoseOf(source);
  Eigen::Matrix3d sonar_from_sensor;
  sonar_from_sensor << 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0;
  pugi::xml_node placed = world.append_copy(model);
  pugi::xml_node pose_node = placed.prepend_child("pose");
  pose_node.text().set((VectorText(pose.position_m) + " " +
                        VectorText(RollPitchYaw(pose.rotation.toRotationMatrix() * sonar_from_sensor)))
                           .c_str());
  placed.prepend_child("static").text().set("true");

  std::vector<ExportedFile> files(1);
  for (const ScenePart& part : ScenePartsOf(source)) {
    AddScenePart(world, part.name, name + part.file.suffix);
    files.push_back(part.file);
  }
  std::ostringstream text;
  document.save(text, "  ");
  files.front() = {kWorldSuffix, text.str()};
  return files;
}

}  // namespace sonarcal::exporting
