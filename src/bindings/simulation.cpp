// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include <memory>

#include "image_arrays.hpp"
#include "params.hpp"
#include "pose_casters.hpp"
#include "sextant/simulation/arena_camera.hpp"
#include "sextant/simulation/arena_scene.hpp"
#include "sextant/simulation/depth_camera.hpp"
#include "sextant/simulation/room_renderer.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {
namespace {

py::array_t<uint8_t> render(const RoomRenderer& renderer, const std::vector<Pose>& exposure,
                            std::uint64_t frame) {
  cv::Mat image;
  {
    const py::gil_scoped_release other_threads_run;
    image = renderer.render(exposure, frame);
  }
  return arrayFromImage(image);
}

void bindRoomRendererScene(py::module_& module) {
  py::class_<RoomObstacle>(module, "RoomObstacle", "A box with its sides parallel to the map's axes.")
      .def(py::init([](const Eigen::Vector3d& center, const Eigen::Vector3d& size, double reflectance) {
             return RoomObstacle{center, size, reflectance};
           }),
           "center"_a, "size"_a, "reflectance"_a = 0.5)
      .def_readwrite("center", &RoomObstacle::center, "(3,) metres, map")
      .def_readwrite("size", &RoomObstacle::size, "(3,) metres")
      .def_readwrite("reflectance", &RoomObstacle::reflectance, "[0, 1]");
  bindParams<RoomSceneParams>(module, "RoomSceneParams", "Geometry and light of a RoomScene.")
      .def_readwrite("obstacles", &RoomSceneParams::obstacles, "list of RoomObstacle");
  py::class_<RoomScene, std::shared_ptr<RoomScene>>(module, "RoomScene", "A room with printed markers.")
      .def(py::init<const RoomSceneParams&, const MarkerMap&>(), "params"_a, "map"_a,
           "ValueError for a parameter out of range, or a marker outside the room.")
      .def("contains", &RoomScene::contains, "p_map"_a, "Whether a point (3, metres) is in the room.");
}

void bindRoomRenderer(py::module_& module) {
  bindRoomRendererScene(module);
  bindParams<RoomRendererParams>(module, "RoomRendererParams", "Sensor and lens of a RoomRenderer.");
  py::class_<RoomRenderer>(module, "RoomRenderer", "Renders images of a room.")
      .def(py::init<const RoomRendererParams&, std::shared_ptr<RoomScene>, const CameraModel&>(), "params"_a,
           "scene"_a, "camera"_a)
      .def("render", &render, "exposure"_a, "frame"_a,
           "Renders a grey image, uint8 (height, width). exposure: list of T_map_camera (4, 4) during the "
           "exposure time; frame: seed of the noise. ValueError without a pose, or for a camera outside the "
           "room.");
}

py::tuple take(ArenaCamera& camera, const ArenaScene& scene, const Pose& T_map_camera, std::uint64_t frame) {
  ArenaCamera::Frame rendered;
  {
    const py::gil_scoped_release other_threads_run;
    rendered = camera.take(scene, T_map_camera, frame);
  }
  return py::make_tuple(arrayFromColour(rendered.image), rendered.objects);
}

py::array takeDepth(DepthCamera& camera, const ArenaScene& scene, const Pose& T_map_camera,
                    std::uint64_t frame) {
  cv::Mat image;
  {
    const py::gil_scoped_release other_threads_run;
    image = camera.take(scene, T_map_camera, frame);
  }
  return arrayFromMatrix(image);
}

void setTexture(ArenaScene& scene, int surface, const ImageArray& photo, double width) {
  if (photo.ndim() != 3 || photo.shape(2) != 3) throw py::value_error("a photo must be (height, width, 3)");
  // Not changed: the scene resizes it to a copy.
  auto* const pixels = const_cast<uint8_t*>(photo.data());  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  scene.setTexture(
      surface, {static_cast<int>(photo.shape(0)), static_cast<int>(photo.shape(1)), CV_8UC3, pixels}, width);
}

void bindArenaScene(py::module_& module) {
  py::class_<ArenaObject> object(module, "ArenaObject", "An upright pillar, a ball or an upright box.");
  py::enum_<ArenaObject::Shape>(object, "Shape")
      .value("pillar", ArenaObject::Shape::pillar)
      .value("ball", ArenaObject::Shape::ball)
      .value("box", ArenaObject::Shape::box);
  object.def(py::init<>())
      .def_readwrite("shape", &ArenaObject::shape, "ArenaObject.Shape")
      .def_readwrite("position", &ArenaObject::position,
                     "(3,) foot of a pillar, centre of a ball or of a box's bottom, metres")
      .def_readwrite("radius", &ArenaObject::radius, "of a pillar or ball, metres, (0, 10]")
      .def_readwrite("height", &ArenaObject::height, "of a pillar or box, metres, (0, 10]")
      .def_readwrite("sides", &ArenaObject::sides, "(2,) of a box, metres, (0, 10]")
      .def_readwrite("yaw", &ArenaObject::yaw, "from the map's x axis to a box's first side, radians")
      .def_readwrite("colour", &ArenaObject::colour, "(3,) reflectance for red, green and blue, [0, 1]")
      .def_readwrite("dirt", &ArenaObject::dirt, "fraction of the light lost in the darkest smudges, [0, 1]")
      .def_property_readonly("reach", &ArenaObject::reach, "largest distance from its vertical axis, metres");
  bindParams<ArenaLight>(module, "ArenaLight", "Lighting of the arena.");
  bindParams<ArenaSceneParams>(module, "ArenaSceneParams", "Geometry of an ArenaScene.");
  py::class_<ArenaScene>(module, "ArenaScene", "A room with a patterned floor and walls, and objects in it.")
      .def(py::init<const ArenaSceneParams&>(), "params"_a)
      .def("set_objects", &ArenaScene::setObjects, "objects"_a,
           "Replaces all objects by a list of ArenaObject. ValueError for a value out of range.")
      .def("set_light", &ArenaScene::setLight, "light"_a, "Sets the ArenaLight.")
      .def("set_texture", &setTexture, "surface"_a, "photo"_a, "width"_a,
           "Covers a surface of the room (0 floor, 1 to 4 walls at -x, x, -y and y, 5 ceiling) with copies "
           "of a photo, uint8 (height, width, 3) RGB, width metres wide, [0.1, 20]; of reflectance "
           "(level / 255)^2.2. ValueError for another surface, photo or width.");
}

void bindArenaParams(py::module_& module) {
  bindParams<ArenaCameraParams>(module, "ArenaCameraParams", "Sensor of an ArenaCamera.");
  bindParams<DepthCameraParams>(module, "DepthCameraParams", "Noise and range of a DepthCamera.");
}

void bindArena(py::module_& module) {
  bindArenaScene(module);
  bindArenaParams(module);
  py::class_<VisibleObject>(module, "VisibleObject",
                            "The visible part of an object in an image; low <= pixel < high.")
      .def_readonly("object", &VisibleObject::object, "index of the object in the scene")
      .def_readonly("low", &VisibleObject::low, "(2,) first column and row of the bounding box, pixels")
      .def_readonly("high", &VisibleObject::high, "(2,) column and row after the bounding box, pixels")
      .def_readonly("pixels", &VisibleObject::pixels, "number of visible pixels");
  py::class_<ArenaCamera>(module, "ArenaCamera", "Renders colour images of an arena.")
      .def(py::init<const ArenaCameraParams&, const CameraModel&>(), "params"_a, "camera"_a)
      .def("take", &take, "scene"_a, "T_map_camera"_a, "frame"_a,
           "Renders an image. Returns (image, objects): uint8 (height, width, 3) RGB, and a list of "
           "VisibleObject. frame: seed of the noise. ValueError for a camera outside the arena.")
      .def(
          "mask", [](const ArenaCamera& camera) { return arrayFromImage(camera.mask()); },
          "Pixels of the last image in which an object is visible, uint8 (height, width): 255, others 0.");
  py::class_<DepthCamera>(module, "DepthCamera", "A stereo depth camera in an arena.")
      .def(py::init<const DepthCameraParams&, const CameraModel&>(), "params"_a, "camera"_a)
      .def(
          "take", &takeDepth, "scene"_a, "T_map_camera"_a, "frame"_a,
          "Renders a depth image, float32 (height, width), metres along the optical axis; 0: invalid. frame: "
          "seed of the noise. ValueError for a camera outside the arena.");
}

}  // namespace
}  // namespace sextant

PYBIND11_MODULE(simulation, module) {
  module.doc() = "Simulated rooms and arenas.";
  py::module_::import("sextant._core.geometry");
  py::module_::import("sextant._core.markers");
  sextant::bindRoomRenderer(module);
  sextant::bindArena(module);
}
