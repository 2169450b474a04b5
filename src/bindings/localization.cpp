// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include "marker_casters.hpp"
#include "params.hpp"
#include "pose_casters.hpp"
#include "sextant/localization/marker_localization.hpp"
#include "sextant/localization/marker_locator_node_params.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {
namespace {

void bindMarkerLocatorResult(py::module_& module) {
  py::class_<LocatedPose>(module, "LocatedPose")
      .def_readonly("T_map_base", &LocatedPose::T_map_base)
      .def_readonly("covariance", &LocatedPose::covariance, "6 x 6, order of PoseWithCovariance")
      .def_readonly("reprojection_error", &LocatedPose::reprojection_error, "RMS, pixels")
      .def_property_readonly("used", [](const LocatedPose& pose) { return pairs(pose.used()); })
      .def_property_readonly("left_out", [](const LocatedPose& pose) { return pairs(pose.leftOut()); })
      .def_readonly("probability", &LocatedPose::probability);
  py::class_<LocatorResult>(module, "LocatorResult", "Either a pose or the reason why there is none.")
      .def_readonly("pose", &LocatorResult::pose)
      .def_readonly("reason", &LocatorResult::reason)
      .def_property_readonly("unmapped", [](const LocatorResult& result) { return pairs(result.unmapped); })
      .def_property_readonly("repeated", [](const LocatorResult& result) { return pairs(result.repeated); });
}

void bindMarkerLocator(py::module_& module) {
  bindMarkerLocatorResult(module);
  py::class_<MarkerView>(module, "MarkerView", "What one camera saw at one instant.")
      .def(py::init<CameraModel, Pose, std::vector<Detection>>(), "camera"_a, "T_base_camera"_a,
           "detections"_a)
      .def_readonly("detections", &MarkerView::detections)
      .def_readwrite("camera_index", &MarkerView::camera_index, "which of the robot's cameras, from 0")
      .def_readwrite("noise_scale", &MarkerView::noise_scale);
  bindParams<LocatorParams>(module, "LocatorParams");
  py::class_<PosePrior>(module, "PosePrior", "What is known of a pose before the image.")
      .def(py::init<Pose, Matrix6d>(), "T_map_base"_a, "covariance"_a);
  py::class_<MarkerLocator>(module, "MarkerLocator", "Locates a robot from mapped markers.")
      .def(py::init<const LocatorParams&>(), "params"_a = LocatorParams())
      .def(
          "locate",
          [](const MarkerLocator& self, const MarkerMap& map, const std::vector<MarkerView>& views,
             const std::optional<PosePrior>& prior) { return self.locate(map, views, prior); },
          "map"_a, "views"_a, "prior"_a = py::none(), "LocatorResult; views: MarkerView of one instant.");
  module.def("locator_modes", &locatorModes);
}

void bindMarkerLocalization(py::module_& module) {
  bindParams<OdometryParams>(module, "OdometryParams");
  bindParams<LocalizationParams>(module, "LocalizationParams")
      .def_readwrite("locator", &LocalizationParams::locator)
      .def_readwrite("odometry", &LocalizationParams::odometry);
  bindParams<MarkerLocatorNodeParams>(module, "MarkerLocatorNodeParams",
                                      "Of the nodelet sextant/MarkerLocator.")
      .def_readwrite("localization", &MarkerLocatorNodeParams::localization)
      .def_readwrite("text", &MarkerLocatorNodeParams::text);
  py::class_<MovedMarker>(module, "MovedMarker", "A marker that does not stand where the map has it.")
      .def_property_readonly("family", [](const MovedMarker& marker) { return marker.key.family; })
      .def_property_readonly("id", [](const MovedMarker& marker) { return marker.key.id; })
      .def_readonly("offset", &MovedMarker::offset, "where it is seen minus where the map has it, metres")
      .def_readonly("images", &MovedMarker::images, "in which it was seen elsewhere");
  py::class_<MarkerLocalization>(module, "MarkerLocalization",
                                 "Locates a robot image by image: what the locator node does, without ROS.")
      .def(py::init<const LocalizationParams&>(), "params"_a = LocalizationParams())
      .def_property("params", &MarkerLocalization::params, &MarkerLocalization::setParams)
      .def("locate", &MarkerLocalization::locate, "map"_a, "views"_a, "T_odom_base"_a = py::none(),
           "LocatorResult; views: MarkerView of one instant, one a camera.")
      .def_property_readonly(
          "T_map_odom", [](const MarkerLocalization& self) { return self.correction().transform(); },
          "4 x 4, or None before the first pose with odometry")
      .def_property_readonly("moved", [](const MarkerLocalization& self) { return self.watch().moved(); })
      .def(
          "noise_scale",
          [](const MarkerLocalization& self, size_t camera) { return self.noise().typical(camera); },
          "camera"_a = 0, "factor on corner_sigma of most images of this camera, by their residuals")
      .def("reset", &MarkerLocalization::reset,
           "Forgets everything: another map, or a clock that jumped back.");
}

}  // namespace
}  // namespace sextant

PYBIND11_MODULE(localization, module) {
  module.doc() = "Locates a robot from mapped markers.";
  py::module_::import("sextant._core.geometry");
  py::module_::import("sextant._core.markers");
  sextant::bindMarkerLocator(module);
  sextant::bindMarkerLocalization(module);
}
