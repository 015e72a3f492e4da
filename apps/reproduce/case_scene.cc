#include "apps/reproduce/case_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "data_io/scenes/cad_io.h"
#include "sim/scenes/scene_primitives.h"
#include "sim/scenes/scenes.h"

namespace sonarcal::reproduce {
namespace {

using data_io::JsonReader;
using data_io::NumberRange;

const NumberRange kLengthM = NumberRange::AboveUpTo(0.0, 1e4);

Scene ReadTurnedSolid(const JsonReader& json) {
  const double length_m = json.At("length_m").Number(kLengthM);
  const JsonReader radii = json.At("radii_mm");
  std::vector<sim::ProfilePoint> outline;
  for (const JsonReader& knot : radii.Items()) {
    const std::vector<double> numbers = knot.Numbers(NumberRange::Between(0.0, 1e6));
    if (numbers.size() != 2 || !(numbers[0] <= 1.0) || !(numbers[1] > 0.0))
      knot.Fail("must be a position in parts of the length, 0 .. 1, and a radius above 0");
    outline.push_back({(numbers[0] - 0.5) * length_m, 1e-3 * numbers[1]});
    if (outline.size() > 1 && !(outline.back().axial_m > outline[outline.size() - 2].axial_m))
      knot.Fail("must lie nearer to the tip than the one before");
  }
  if (outline.size() < 2) radii.Fail("needs two radii or more");
  return sim::MakeTurnedSolid(outline, json.At("max_edge_m").Number(kLengthM), json.At("material").String());
}

Scene ReadOgiveBody(const JsonReader& json) {
  const auto length_m = [&](const char* key) { return json.At(key).Number(kLengthM); };
  return sim::MakeBody({.length_m = length_m("length_m"),
                        .diameter_m = length_m("diameter_m"),
                        .nose_length_m = length_m("nose_length_m"),
                        .tail_length_m = length_m("tail_length_m"),
                        .tail_diameter_m = length_m("tail_diameter_m"),
                        .max_edge_m = length_m("max_edge_m"),
                        .material = json.At("material").String()});
}

}  // namespace

std::string ReadPathBelow(const JsonReader& json) {
  const std::filesystem::path path = json.String();
  const bool climbs = std::find(path.begin(), path.end(), "..") != path.end();
  if (path.empty() || path.is_absolute() || climbs)
    json.Fail(fmt::format("is \"{}\", expected a path below the folder", path.string()));
  return path.string();
}

Scene ReadCaseScene(const JsonReader& json, const std::filesystem::path& folder) {
  if (const auto file = json.Find("file")) return data_io::ReadScene(folder / ReadPathBelow(*file));
  if (const auto solid = json.Find("turned_solid")) return ReadTurnedSolid(*solid);
  if (const auto body = json.Find("ogive_body")) return ReadOgiveBody(*body);
  const auto [environment, options] = ReadEnvironment(json);
  return environment->make(options);
}

std::pair<const sim::Environment*, sim::EnvironmentOptions> ReadEnvironment(const JsonReader& json) {
  const auto name = json.Find("environment");
  if (!name) json.Fail("needs one of file, environment, turned_solid, ogive_body");
  const sim::Environment* environment = FindNamed(*name, sim::FindEnvironment);
  sim::EnvironmentOptions options;
  json.Update("max_edge_m", options.max_edge_m, kLengthM);
  if (const auto size = json.Find("size")) options.size = size->Word<sim::SizeVariant>();
  if (const auto surface = json.Find("surface")) options.surface = surface->Bool();
  if (const auto bed = json.Find("bed")) options.bed = bed->Bool();
  if (const auto seed = json.Find("seed"))
    options.seed = static_cast<std::uint64_t>(seed->Integer(0, 1LL << 53));
  return {environment, options};
}

}  // namespace sonarcal::reproduce
