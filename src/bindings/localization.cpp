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
  py::class_<LocatedPose>(module, "LocatedPose",
                          "Pose of the base, computed from one or several images of an instant.")
      .def_readonly("T_map_base", &LocatedPose::T_map_base, "(4, 4) pose of the base in the map")
      .def_readonly("covariance", &LocatedPose::covariance,
                    "(6, 6) position, rotation in the map's axes; order of PoseWithCovariance")
      .def_readonly("reprojection_error", &LocatedPose::reprojection_error, "RMS, pixels")
      .def_property_readonly(
          "used", [](const LocatedPose& pose) { return pairs(pose.used()); },
          "(family, id) of the markers from which the pose was computed")
      .def_property_readonly(
          "outliers", [](const LocatedPose& pose) { return pairs(pose.outliers()); },
          "(family, id) of the markers that are inconsistent with the pose")
      .def_readonly("probability", &LocatedPose::probability,
                    "of this pose among all that explain the image");
  py::class_<LocatorResult>(module, "LocatorResult", "A pose, or the reason why there is none.")
      .def_readonly("pose", &LocatorResult::pose, "LocatedPose or None")
      .def_readonly("reason", &LocatorResult::reason, "why there is no pose; empty with a pose")
      .def_property_readonly(
          "unmapped", [](const LocatorResult& result) { return pairs(result.unmapped); },
          "(family, id) of detected markers that are not in the map")
      .def_property_readonly(
          "repeated", [](const LocatorResult& result) { return pairs(result.repeated); },
          "(family, id) of markers detected more than once in one image, and therefore ignored");
}

void bindMarkerLocator(py::module_& module) {
  bindMarkerLocatorResult(module);
  py::class_<MarkerView>(module, "MarkerView", "The detections of one camera at one instant.")
      .def(py::init<CameraModel, Pose, std::vector<Detection>>(), "camera"_a, "T_base_camera"_a,
           "detections"_a)
      .def_readonly("detections", &MarkerView::detections, "list of Detection")
      .def_readwrite("camera_index", &MarkerView::camera_index, "index of the camera, from 0")
      .def_readwrite("noise_scale", &MarkerView::noise_scale, "factor on corner_sigma");
  bindParams<LocatorParams>(module, "LocatorParams", "Parameters of MarkerLocator.");
  py::class_<PosePrior>(module, "PosePrior", "The pose predicted before an image.")
      .def(py::init<Pose, Matrix6d>(), "T_map_base"_a, "covariance"_a);
  py::class_<MarkerLocator>(module, "MarkerLocator", "Locates a robot from mapped markers.")
      .def(py::init<const LocatorParams&>(), "params"_a = LocatorParams())
      .def(
          "locate",
          [](const MarkerLocator& self, const MarkerMap& map, const std::vector<MarkerView>& views,
             const std::optional<PosePrior>& prior) { return self.locate(map, views, prior); },
          "map"_a, "views"_a, "prior"_a = py::none(),
          "Returns a LocatorResult. views: list of MarkerView of one instant; prior: PosePrior that only "
          "resolves "
          "ambiguities, or None.");
  module.def("locator_modes", &locatorModes, "Allowed values of LocatorParams.mode.");
}

void bindLocalizationParams(py::module_& module) {
  bindParams<OdometryParams>(module, "OdometryParams", "Drift of odometry and its gate.");
  bindParams<LocalizationParams>(module, "LocalizationParams", "Parameters of MarkerLocalization.")
      .def_readwrite("locator", &LocalizationParams::locator, "LocatorParams")
      .def_readwrite("odometry", &LocalizationParams::odometry, "OdometryParams");
  bindParams<MarkerLocatorNodeParams>(module, "MarkerLocatorNodeParams",
                                      "Parameters of the nodelet sextant/MarkerLocator.")
      .def_readwrite("localization", &MarkerLocatorNodeParams::localization, "LocalizationParams")
      .def_readwrite("text", &MarkerLocatorNodeParams::text, "TextMapParams");
}

void bindFoundErrors(py::module_& module) {
  py::class_<MovedMarker>(module, "MovedMarker", "A marker that is not at its position in the map.")
      .def_property_readonly(
          "family", [](const MovedMarker& marker) { return marker.key.family; }, "canonical family")
      .def_property_readonly(
          "id", [](const MovedMarker& marker) { return marker.key.id; }, "id in the family")
      .def_readonly("offset", &MovedMarker::offset,
                    "(3,) observed minus mapped position, metres in the map's axes")
      .def_readonly("images", &MovedMarker::images, "number of images that contradict the map");
  py::enum_<ErrorCause>(module, "ErrorCause", "What makes residuals systematic.")
      .value("focal_length", ErrorCause::focal_length)
      .value("centre", ErrorCause::centre)
      .value("distortion", ErrorCause::distortion)
      .value("shutter", ErrorCause::shutter)
      .value("marker_size", ErrorCause::marker_size)
      .value("map", ErrorCause::map);
  py::class_<SystematicError>(module, "SystematicError",
                              "A systematic error that explains the residuals of many images.")
      .def_readonly("cause", &SystematicError::cause, "ErrorCause")
      .def_readonly("camera", &SystematicError::camera, "index of the camera")
      .def_readonly("value", &SystematicError::value, "(N,) estimated error")
      .def_readonly("sigma", &SystematicError::sigma, "(N,) its standard deviation");
}

void bindMarkerLocalization(py::module_& module) {
  py::class_<MarkerLocalization>(
      module, "MarkerLocalization",
      "Locates a robot in successive images: the algorithm of the locator node without ROS.")
      .def(py::init<const LocalizationParams&>(), "params"_a = LocalizationParams())
      .def_property("params", &MarkerLocalization::params, &MarkerLocalization::setParams,
                    "LocalizationParams; setting them keeps the state")
      .def("locate", &MarkerLocalization::locate, "map"_a, "views"_a, "T_odom_base"_a = py::none(),
           "stamp"_a = py::none(),
           "Returns a LocatorResult. views: list of MarkerView of one instant, one per camera; T_odom_base: "
           "odometry at that instant, or None; stamp: of the instant, seconds, or None: a rolling shutter is "
           "not found.")
      .def_property_readonly(
          "T_map_odom", [](const MarkerLocalization& self) { return self.correction().transform(); },
          "(4, 4), or None before the first pose with odometry")
      .def_property_readonly(
          "moved", [](const MarkerLocalization& self) { return self.movedMarkers().moved(); },
          "list of MovedMarker")
      .def(
          "noise_scale",
          [](const MarkerLocalization& self, size_t camera) { return self.noise().typical(camera); },
          "camera"_a = 0, "Median factor on corner_sigma for this camera, estimated from residuals.")
      .def_property_readonly(
          "errors", [](const MarkerLocalization& self) { return self.errors().errors(); },
          "list of SystematicError")
      .def("reset", &MarkerLocalization::reset,
           "Resets everything. To be called for another map, or when the clock jumps back.");
}

}  // namespace
}  // namespace sextant

PYBIND11_MODULE(localization, module) {
  module.doc() = "Locates a robot from mapped markers.";
  py::module_::import("sextant._core.geometry");
  py::module_::import("sextant._core.markers");
  sextant::bindMarkerLocator(module);
  sextant::bindLocalizationParams(module);
  sextant::bindFoundErrors(module);
  sextant::bindMarkerLocalization(module);
}
