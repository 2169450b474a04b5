// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/marker_locator.hpp"

#include "bindings.hpp"
#include "casters.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {
namespace {

void bindResult(py::module_& module) {
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

}  // namespace

void bindMarkerLocator(py::module_& module) {
  bindResult(module);
  py::class_<MarkerView>(module, "MarkerView", "What one camera saw at one instant.")
      .def(py::init<CameraModel, Pose, std::vector<Detection>>(), "camera"_a, "T_base_camera"_a,
           "detections"_a)
      .def_readonly("detections", &MarkerView::detections)
      .def_readwrite("camera_index", &MarkerView::camera_index, "which of the robot's cameras, from 0")
      .def_readwrite("noise_scale", &MarkerView::noise_scale);
  py::class_<LocatorParams>(module, "LocatorParams")
      .def(py::init<>())
      .def_readwrite("mode", &LocatorParams::mode)
      .def_readwrite("corner_sigma", &LocatorParams::corner_sigma)
      .def_readwrite("max_reprojection_error", &LocatorParams::max_reprojection_error)
      .def_readwrite("robust_width", &LocatorParams::robust_width)
      .def_readwrite("gate", &LocatorParams::gate)
      .def_readwrite("floor_height_sigma", &LocatorParams::floor_height_sigma)
      .def_readwrite("floor_tilt_sigma", &LocatorParams::floor_tilt_sigma)
      .def_readwrite("decided", &LocatorParams::decided)
      .def_readwrite("ambiguous", &LocatorParams::ambiguous)
      .def_readwrite("constant_covariance", &LocatorParams::constant_covariance)
      .def("validate", &LocatorParams::validate);
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

}  // namespace sextant
