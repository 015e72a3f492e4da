#include "data_io/sonars/frame_tree.h"

#include <fmt/format.h>

#include "core/types/printable.h"
#include "core/types/rotation.h"
#include "data_io/files/yaml_reader.h"

namespace sonarcal::data_io {
namespace {

Pose PoseOf(const YamlReader& frame) {
  const YamlReader translation = frame.At("translation");
  const YamlReader rotation = frame.At("rotation");
  const auto number = [](const YamlReader& of, const char* key) { return of.At(key).Number(); };
  const Eigen::Quaterniond written(number(rotation, "w"), number(rotation, "x"), number(rotation, "y"),
                                   number(rotation, "z"));
  const auto turn = UnitQuaternion(written);
  if (!turn) rotation.Fail(fmt::format("is a quaternion of length {:g}, expected 1", written.norm()));
  return {*turn, {number(translation, "x"), number(translation, "y"), number(translation, "z")}};
}

}  // namespace

FrameTree::FrameTree(const std::filesystem::path& file) {
  for (const auto& [heading, list] : YamlReader::FromFile(file).Members()) {
    for (const YamlReader& frame : list.Items()) {
      const YamlReader name = frame.At("frame_id");
      const bool is_new =
          frames_.emplace(name.String(), Frame{frame.At("parent_frame_id").String(), PoseOf(frame)}).second;
      if (!is_new) name.Fail(fmt::format("'{}' occurs twice", Printable(name.String())));
    }
  }
}

std::optional<Pose> FrameTree::Find(const std::string& ancestor, const std::string& frame) const {
  Pose ancestor_from_frame;
  std::string at = frame;
  // A chain with more steps than frames is a cycle.
  for (std::size_t step = 0; at != ancestor; ++step) {
    const auto found = frames_.find(at);
    if (found == frames_.end() || step > frames_.size()) return std::nullopt;
    ancestor_from_frame = found->second.parent_from_frame * ancestor_from_frame;
    at = found->second.parent;
  }
  return ancestor_from_frame;
}

}  // namespace sonarcal::data_io
