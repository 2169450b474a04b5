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
  py::class_<RoomObstacle>(module, "RoomObstacle", "A box with its sides along the map's axes; metres.")
      .def(py::init([](const Eigen::Vector3d& center, const Eigen::Vector3d& size, double reflectance) {
             return RoomObstacle{center, size, reflectance};
           }),
           "center"_a, "size"_a, "reflectance"_a = 0.5)
      .def_readwrite("center", &RoomObstacle::center)
      .def_readwrite("size", &RoomObstacle::size)
      .def_readwrite("reflectance", &RoomObstacle::reflectance);
  bindParams<RoomSceneParams>(module, "RoomSceneParams")
      .def_readwrite("obstacles", &RoomSceneParams::obstacles);
  py::class_<RoomScene, std::shared_ptr<RoomScene>>(module, "RoomScene", "A room with printed markers.")
      .def(py::init<const RoomSceneParams&, const MarkerMap&>(), "params"_a, "map"_a,
           "ValueError for a parameter out of range, or a marker outside of the room.")
      .def("contains", &RoomScene::contains, "p_map"_a);
}

void bindRoomRenderer(py::module_& module) {
  bindRoomRendererScene(module);
  bindParams<RoomRendererParams>(module, "RoomRendererParams");
  py::class_<RoomRenderer>(module, "RoomRenderer", "Takes pictures in a room.")
      .def(py::init<const RoomRendererParams&, std::shared_ptr<RoomScene>, const CameraModel&>(), "params"_a,
           "scene"_a, "camera"_a)
      .def("render", &render, "exposure"_a, "frame"_a,
           "Grey uint8 (height, width) from a list of T_map_camera (4, 4) during the exposure; `frame` "
           "chooses the\n"
           "noise. ValueError for no pose, or a camera outside of the room.");
}

py::tuple take(ArenaCamera& camera, const ArenaScene& scene, const Pose& T_map_camera, std::uint64_t frame) {
  ArenaCamera::Picture picture;
  {
    const py::gil_scoped_release other_threads_run;
    picture = camera.take(scene, T_map_camera, frame);
  }
  return py::make_tuple(arrayFromColour(picture.image), picture.seen);
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

void bindArenaScene(py::module_& module) {
  py::class_<ArenaObject> object(module, "ArenaObject",
                                 "A pillar or a ball. Units and ranges: arena_scene.hpp.");
  py::enum_<ArenaObject::Shape>(object, "Shape")
      .value("pillar", ArenaObject::Shape::pillar)
      .value("ball", ArenaObject::Shape::ball);
  object.def(py::init<>())
      .def_readwrite("shape", &ArenaObject::shape)
      .def_readwrite("position", &ArenaObject::position)
      .def_readwrite("radius", &ArenaObject::radius)
      .def_readwrite("height", &ArenaObject::height)
      .def_readwrite("colour", &ArenaObject::colour);
  bindParams<ArenaLight>(module, "ArenaLight", "The light of the moment.");
  bindParams<ArenaSceneParams>(module, "ArenaSceneParams");
  py::class_<ArenaScene>(module, "ArenaScene", "A room with a patterned floor and walls, and what is in it.")
      .def(py::init<const ArenaSceneParams&>(), "params"_a)
      .def("set_objects", &ArenaScene::setObjects, "objects"_a)
      .def("set_light", &ArenaScene::setLight, "light"_a);
}

void bindArenaParams(py::module_& module) {
  bindParams<ArenaCameraParams>(module, "ArenaCameraParams");
  bindParams<DepthCameraParams>(module, "DepthCameraParams");
}

void bindArena(py::module_& module) {
  bindArenaScene(module);
  bindArenaParams(module);
  py::class_<SeenObject>(module, "SeenObject", "What of an object a picture shows; low <= pixel < high.")
      .def_readonly("object", &SeenObject::object)
      .def_readonly("low", &SeenObject::low)
      .def_readonly("high", &SeenObject::high)
      .def_readonly("pixels", &SeenObject::pixels);
  py::class_<ArenaCamera>(module, "ArenaCamera", "Takes colour pictures in an arena.")
      .def(py::init<const ArenaCameraParams&, const CameraModel&>(), "params"_a, "camera"_a)
      .def("take", &take, "scene"_a, "T_map_camera"_a, "frame"_a,
           "uint8 (height, width, 3), red first, and the SeenObject in it; `frame` chooses the noise.\n"
           "ValueError for a camera outside of the arena.");
  py::class_<DepthCamera>(module, "DepthCamera", "A stereo depth camera in an arena.")
      .def(py::init<const DepthCameraParams&, const CameraModel&>(), "params"_a, "camera"_a)
      .def("take", &takeDepth, "scene"_a, "T_map_camera"_a, "frame"_a,
           "float32 (height, width), metres along the optical axis, 0 where there is none.\n"
           "ValueError for a camera outside of the arena.");
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
