// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bindings.hpp"
#include "casters.hpp"
#include "sextant/simulation/arena_camera.hpp"
#include "sextant/simulation/arena_scene.hpp"
#include "sextant/simulation/depth_camera.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {
namespace {

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

void bindScene(py::module_& module) {
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
  py::class_<ArenaLight>(module, "ArenaLight", "The light of the moment.")
      .def(py::init<>())
      .def_readwrite("brightness", &ArenaLight::brightness)
      .def_readwrite("direct", &ArenaLight::direct)
      .def_readwrite("toward", &ArenaLight::toward)
      .def_readwrite("tint", &ArenaLight::tint)
      .def("validate", &ArenaLight::validate);
  py::class_<ArenaSceneParams>(module, "ArenaSceneParams", "Units and ranges: arena_scene.hpp.")
      .def(py::init<>())
      .def_readwrite("size", &ArenaSceneParams::size)
      .def_readwrite("wall_height", &ArenaSceneParams::wall_height)
      .def_readwrite("seed", &ArenaSceneParams::seed)
      .def("validate", &ArenaSceneParams::validate);
  py::class_<ArenaScene>(module, "ArenaScene", "A room with a patterned floor and walls, and what is in it.")
      .def(py::init<const ArenaSceneParams&>(), "params"_a)
      .def("set_objects", &ArenaScene::setObjects, "objects"_a)
      .def("set_light", &ArenaScene::setLight, "light"_a);
}

void bindParams(py::module_& module) {
  py::class_<ArenaCameraParams>(module, "ArenaCameraParams", "Units and ranges: arena_camera.hpp.")
      .def(py::init<>())
      .def_readwrite("supersampling", &ArenaCameraParams::supersampling)
      .def_readwrite("blur_sigma", &ArenaCameraParams::blur_sigma)
      .def_readwrite("noise_sigma", &ArenaCameraParams::noise_sigma)
      .def_readwrite("white_level", &ArenaCameraParams::white_level)
      .def_readwrite("gamma", &ArenaCameraParams::gamma)
      .def_readwrite("seed", &ArenaCameraParams::seed)
      .def("validate", &ArenaCameraParams::validate);
  py::class_<DepthCameraParams>(module, "DepthCameraParams", "Units and ranges: depth_camera.hpp.")
      .def(py::init<>())
      .def_readwrite("noise", &DepthCameraParams::noise)
      .def_readwrite("scale", &DepthCameraParams::scale)
      .def_readwrite("baseline", &DepthCameraParams::baseline)
      .def_readwrite("min_depth", &DepthCameraParams::min_depth)
      .def_readwrite("max_depth", &DepthCameraParams::max_depth)
      .def_readwrite("holes", &DepthCameraParams::holes)
      .def_readwrite("seed", &DepthCameraParams::seed)
      .def("validate", &DepthCameraParams::validate);
}

}  // namespace

void bindArena(py::module_& module) {
  bindScene(module);
  bindParams(module);
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

}  // namespace sextant
