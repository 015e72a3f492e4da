#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <Eigen/Geometry>
#include <memory>
#include <numeric>

#include "apps/cli/scene_option.h"
#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/option_objects.h"
#include "data_io/scenes/scene_io.h"
#include "sim/scenes/environments.h"

namespace sonarcal::python {
namespace {

namespace py = pybind11;

using IndexArray = py::array_t<std::int32_t, py::array::c_style | py::array::forcecast>;

Scene MakeScene(const FloatArray& vertices_m, const IndexArray& triangles,
                const IndexArray& triangle_material, std::vector<std::string> material_names) {
  if (vertices_m.ndim() != 2 || vertices_m.shape(1) != 3)
    throw DataError("vertices_m: expected the shape (n, 3)");
  if (triangles.ndim() != 2 || triangles.shape(1) != 3)
    throw DataError("triangles: expected the shape (n, 3)");
  if (triangle_material.ndim() != 1 || triangle_material.shape(0) != triangles.shape(0)) {
    throw DataError("triangle_material: expected one index for each of the {} triangles", triangles.shape(0));
  }
  Scene scene;
  scene.material_names = std::move(material_names);
  for (py::ssize_t i = 0; i < vertices_m.shape(0); ++i)
    scene.vertices_m.emplace_back(vertices_m.at(i, 0), vertices_m.at(i, 1), vertices_m.at(i, 2));
  for (py::ssize_t i = 0; i < triangles.shape(0); ++i)
    scene.triangles.emplace_back(triangles.at(i, 0), triangles.at(i, 1), triangles.at(i, 2));
  for (py::ssize_t i = 0; i < triangle_material.shape(0); ++i) {
    const std::int32_t material = triangle_material.at(i);
    if (material < 0 || static_cast<std::size_t>(material) >= scene.material_names.size()) {
      throw DataError("triangle_material: {} at index {}, expected 0 .. {}", material, i,
                      static_cast<int>(scene.material_names.size()) - 1);
    }
    scene.triangle_material.push_back(static_cast<std::uint16_t>(material));
  }
  scene.Validate("scene");
  return scene;
}

py::array_t<float> BoundsOf(const Scene& scene) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex_m : scene.vertices_m) box.extend(vertex_m);
  const float bounds[] = {box.min().x(), box.min().y(), box.min().z(),
                          box.max().x(), box.max().y(), box.max().z()};
  return py::array_t<float>({2, 3}, bounds);
}

// None leaves `value` absent. Throws UsageError naming `option` for anything but a word of the enumeration.
template <HasWords E>
void ReadWord(const char* option, const py::object& object, std::optional<E>& value) {
  if (!object.is_none()) value = OptionFromObject<E>({.name = option, .help = {}}, object);
}

Scene ReadSceneOf(const std::filesystem::path& file, const py::object& scene_unit,
                  const py::object& scene_up) {
  cli::SceneFormat format;
  ReadWord("scene_unit", scene_unit, format.unit);
  ReadWord("scene_up", scene_up, format.up);
  const cli::CommonOptions quiet{.json = false, .quiet = true};
  const py::gil_scoped_release release;
  return cli::ReadSceneFile(file, format, quiet);
}

}  // namespace

void BindScene(py::module_& module) {
  py::class_<Scene, std::shared_ptr<Scene>>(
      module, "Scene",
      "A triangle mesh in world coordinates (metres, Z up), each triangle of one "
      "named material.")
      .def(py::init(&MakeScene), py::arg("vertices_m"), py::arg("triangles"), py::arg("triangle_material"),
           py::arg("material_names"))
      .def_property_readonly(
          "vertices_m",
          [](const py::object& self) {
            const auto& vertices = self.cast<const Scene&>().vertices_m;
            static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
            return View(reinterpret_cast<const float*>(vertices.data()),
                        {static_cast<py::ssize_t>(vertices.size()), 3}, self);
          },
          "Corners, shape (n, 3), float32, metres; a read-only view.")
      .def_property_readonly(
          "triangles",
          [](const py::object& self) {
            const auto& triangles = self.cast<const Scene&>().triangles;
            static_assert(sizeof(Eigen::Vector3i) == 3 * sizeof(int));
            return View(reinterpret_cast<const int*>(triangles.data()),
                        {static_cast<py::ssize_t>(triangles.size()), 3}, self);
          },
          "Indices of corners, counter-clockwise seen from outside, shape (n, 3), int32; a read-only view.")
      .def_property_readonly(
          "triangle_material",
          [](const py::object& self) { return View(self.cast<const Scene&>().triangle_material, self); },
          "Index into material_names, shape (triangles,), uint16; a read-only view.")
      .def_readonly("material_names", &Scene::material_names, "Names by which parameters know the materials.")
      .def_property_readonly("bounds_m", &BoundsOf, "Lowest and highest corner, shape (2, 3), metres.")
      .def(
          "save",
          [](const Scene& scene, const std::filesystem::path& file) { data_io::WriteGltf(scene, file); },
          py::arg("file"), py::call_guard<py::gil_scoped_release>(),
          "Writes glTF: .gltf, or .glb; whole or not at all.")
      .def("__repr__", [](const Scene& scene) {
        std::string names;
        for (const std::string& name : scene.material_names) names += (names.empty() ? "" : ", ") + name;
        return fmt::format("Scene({} triangles, materials {})", scene.triangles.size(), names);
      });
  module.def(
      "read_scene", &ReadSceneOf, py::arg("file"), py::kw_only(), py::arg("scene_unit") = py::none(),
      py::arg("scene_up") = py::none(),
      "A scene from glTF, OBJ, STL or PLY. For the last three: scene_unit 'm', 'cm', 'mm', 'in' or 'ft', "
      "scene_up 'y' or\n"
      "'z'.");
  module.def(
      "environments",
      [] {
        std::map<std::string, std::string> described;
        for (const sim::Environment& environment : sim::Environments())
          described.emplace(environment.name, environment.description);
        return described;
      },
      "Names of the paper's scenes, each with a line about it.");
  module.def(
      "environment",
      [](const std::string& name, double max_edge_m, bool surface, std::uint64_t seed, bool bed) {
        return sim::FindEnvironment(name).make(
            {.max_edge_m = max_edge_m, .surface = surface, .seed = seed, .bed = bed});
      },
      py::arg("name"), py::arg("max_edge_m") = 0.0, py::arg("surface") = false, py::arg("seed") = 1,
      py::arg("bed") = false, py::call_guard<py::gil_scoped_release>(),
      "One of the paper's scenes. max_edge_m: longest side of the mesh's cells, 0 for the scene's own; "
      "surface: the\n"
      "tank's water surface too; seed: of the seabed; bed: a flat bed below what would stand free.");
  module.def(
      "viewpoints", [](const std::string& name) { return sim::FindEnvironment(name).viewpoints(); },
      py::arg("name"), "Poses to look at a scene from.");
}

}  // namespace sonarcal::python
