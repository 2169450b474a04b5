// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/simulation/room_renderer.hpp"

#include <memory>

#include "bindings.hpp"
#include "casters.hpp"

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

void bindScene(py::module_& module) {
  py::class_<RoomObstacle>(module, "RoomObstacle", "A box with its sides along the map's axes; metres.")
      .def(py::init([](const Eigen::Vector3d& center, const Eigen::Vector3d& size, double reflectance) {
             return RoomObstacle{center, size, reflectance};
           }),
           "center"_a, "size"_a, "reflectance"_a = 0.5)
      .def_readwrite("center", &RoomObstacle::center)
      .def_readwrite("size", &RoomObstacle::size)
      .def_readwrite("reflectance", &RoomObstacle::reflectance);
  py::class_<RoomSceneParams>(module, "RoomSceneParams", "Units and ranges: room_scene.hpp.")
      .def(py::init<>())
      .def_readwrite("size", &RoomSceneParams::size)
      .def_readwrite("floor_center", &RoomSceneParams::floor_center)
      .def_readwrite("quiet_zone", &RoomSceneParams::quiet_zone)
      .def_readwrite("light_unevenness", &RoomSceneParams::light_unevenness)
      .def_readwrite("seed", &RoomSceneParams::seed)
      .def_readwrite("obstacles", &RoomSceneParams::obstacles)
      .def("validate", &RoomSceneParams::validate);
  py::class_<RoomScene, std::shared_ptr<RoomScene>>(module, "RoomScene", "A room with printed markers.")
      .def(py::init<const RoomSceneParams&, const MarkerMap&>(), "params"_a, "map"_a,
           "ValueError for a parameter out of range, or a marker outside of the room.")
      .def("contains", &RoomScene::contains, "p_map"_a);
}

}  // namespace

void bindRoomRenderer(py::module_& module) {
  bindScene(module);
  py::class_<RoomRendererParams>(module, "RoomRendererParams", "Units and ranges: room_renderer.hpp.")
      .def(py::init<>())
      .def_readwrite("supersampling", &RoomRendererParams::supersampling)
      .def_readwrite("blur_sigma", &RoomRendererParams::blur_sigma)
      .def_readwrite("noise_sigma", &RoomRendererParams::noise_sigma)
      .def_readwrite("vignette", &RoomRendererParams::vignette)
      .def_readwrite("white_level", &RoomRendererParams::white_level)
      .def_readwrite("seed", &RoomRendererParams::seed)
      .def("validate", &RoomRendererParams::validate);
  py::class_<RoomRenderer>(module, "RoomRenderer", "Takes pictures in a room.")
      .def(py::init<const RoomRendererParams&, std::shared_ptr<RoomScene>, const CameraModel&>(), "params"_a,
           "scene"_a, "camera"_a)
      .def("render", &render, "exposure"_a, "frame"_a,
           "Grey uint8 (height, width) from a list of T_map_camera (4, 4) during the exposure; `frame` "
           "chooses the\n"
           "noise. ValueError for no pose, or a camera outside of the room.");
}

}  // namespace sextant
