// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include "image_arrays.hpp"
#include "marker_casters.hpp"
#include "params.hpp"
#include "pose_casters.hpp"
#include "sextant/markers/marker.hpp"
#include "sextant/markers/marker_family.hpp"
#include "sextant/markers/marker_map.hpp"
#include "sextant/markers/marker_map_file.hpp"
#include "sextant/markers/marker_pose.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {
namespace {

void bindMarker(py::module_& module) {
  py::class_<Detection>(module, "Detection", "A marker detected in an image.")
      .def(
          py::init([](const std::string& family, int id, const Corners& corners, const CornerSigmas& sigmas) {
            return Detection{{family, id}, corners, sigmas};
          }),
          "family"_a, "id"_a, "corners"_a, "corner_sigmas"_a = Detection().corner_sigmas)
      .def_property_readonly(
          "family", [](const Detection& self) { return self.key.family; }, "canonical family")
      .def_property_readonly(
          "id", [](const Detection& self) { return self.key.id; }, "id in the family")
      .def_readwrite("corners", &Detection::corners,
                     "(4, 2) pixels: top left, top right, bottom right, bottom left")
      .def_readwrite("corner_sigmas", &Detection::corner_sigmas,
                     "(4,) standard deviations, pixels; -1: unknown")
      .def_readonly("hamming", &Detection::hamming,
                    "number of corrected bits; -1: not reported by the backend")
      .def_readonly("decision_margin", &Detection::decision_margin,
                    "contrast of the bits, grey levels; -1: not reported by the backend")
      .def(py::pickle(
          [](const Detection& each) {
            return py::make_tuple(each.key.family, each.key.id, each.corners, each.corner_sigmas,
                                  each.hamming, each.decision_margin);
          },
          [](const py::tuple& state) {
            return Detection{{state[0].cast<std::string>(), state[1].cast<int>()},
                             state[2].cast<Corners>(),
                             state[3].cast<CornerSigmas>(),
                             state[4].cast<int>(),
                             state[5].cast<double>()};
          }));
}

void bindMarkerCorners(py::module_& module) {
  module.def(
      "marker_corners",
      [](double size) {
        Eigen::Matrix<double, 4, 3> corners;
        for (int i = 0; i < 4; ++i) corners.row(i) = markerCorners(size)[i];
        return corners;
      },
      "size"_a,
      "Returns the corners (4 x 3, metres) in the marker's frame: top left, top right, bottom right, bottom "
      "left.");
}

void bindMarkerFamily(py::module_& module) {
  module.def("marker_families", &markerFamilies, "Returns every family name that detectors and maps accept.");
  module.def("canonical_family", &canonicalFamily, "name"_a,
             "Returns the canonical name of a family: libapriltag's for families that OpenCV has under "
             "another name.");
  module.def("family_size", &familySize, "name"_a, "Returns the number of markers in a family.");
  module.def(
      "marker_image",
      [](const std::string& family, int id) {
        const MarkerImage image = markerImage(family, id);
        return py::make_tuple(arrayFromImage(image.modules), image.border_begin, image.border_end);
      },
      "family"_a, "id"_a,
      "Draws a marker. Returns (modules, begin, end): uint8 image with one pixel per module; the marker's "
      "edge length spans the rows and columns begin to end - 1.");
}

void bindMarkerPose(py::module_& module) {
  py::class_<MarkerPose>(module, "MarkerPose", "One local minimum of a marker's reprojection error.")
      .def_readonly("T_camera_marker", &MarkerPose::T_camera_marker, "(4, 4) pose in the optical frame")
      .def_readonly("reprojection_error", &MarkerPose::reprojection_error, "RMS, pixels");
  py::class_<PlanarPoses>(module, "PlanarPoses",
                          "The two solutions for the pose of a square from its four corners.")
      .def_readonly("best", &PlanarPoses::best, "MarkerPose with the smaller reprojection error")
      .def_readonly("alternative", &PlanarPoses::alternative, "MarkerPose or None")
      .def_property_readonly("ambiguity", &PlanarPoses::ambiguity,
                             "ratio of the reprojection errors, best over alternative, in [0, 1]");
  module.def("solve_marker_pose", &solveMarkerPose, "camera"_a, "corners"_a, "size"_a,
             "Returns the PlanarPoses of a marker with this edge length in metres, or None.");
  module.def(
      "marker_pose_covariance", &markerPoseCovariance, "camera"_a, "T_camera_marker"_a, "size"_a, "sigma"_a,
      "Returns the covariance (6, 6) of position and rotation in the axes of the optical frame, for corner "
      "coordinates with a standard deviation of sigma pixels; None if the corners do not determine it.");
}

MappedMarker makeMappedMarker(const std::string& family, int id, double size, const Pose& T_map_marker,
                              const std::string& name, const Matrix6d& covariance) {
  return {{family, id}, size, name, T_map_marker, covariance};
}

std::vector<MappedMarker> markerList(const MarkerMap& map) {
  std::vector<MappedMarker> markers;
  for (const auto& entry : map.markers()) markers.push_back(entry.second);
  return markers;
}

void bindMarkerMapEntries(py::module_& module) {
  py::class_<MappedMarker>(module, "MappedMarker", "A marker with a known pose.")
      .def(py::init(&makeMappedMarker), "family"_a, "id"_a, "size"_a, "T_map_marker"_a, "name"_a = "",
           "covariance"_a = Matrix6d(Matrix6d::Zero()))
      .def_property_readonly(
          "family", [](const MappedMarker& marker) { return marker.key.family; }, "canonical family")
      .def_property_readonly(
          "id", [](const MappedMarker& marker) { return marker.key.id; }, "id in the family")
      .def_readonly("size", &MappedMarker::size, "edge length, metres")
      .def_readonly("name", &MappedMarker::name, "tf frame")
      .def_readonly("T_map_marker", &MappedMarker::T_map_marker, "(4, 4) pose in the map")
      .def_readonly("covariance", &MappedMarker::covariance,
                    "(6, 6) position, rotation in the map's axes (m^2, rad^2); zero: exact");
  py::class_<MappedFrame>(module, "MappedFrame", "A frame of the map file that is not a marker.")
      .def_readonly("name", &MappedFrame::name, "tf frame")
      .def_readonly("parent", &MappedFrame::parent, "tf frame")
      .def_readonly("T_parent_frame", &MappedFrame::T_parent_frame, "(4, 4) pose in the parent frame");
}

void bindMarkerMap(py::module_& module) {
  bindMarkerMapEntries(module);
  py::class_<MarkerMap>(module, "MarkerMap",
                        "A map of printed markers: poses by family and id, all in one frame.")
      .def(py::init<std::string>(), "frame"_a = "map")
      .def(py::init<const MarkerMap&>(), "other"_a, "A copy.")
      .def_property_readonly("frame", &MarkerMap::frame, "tf frame of the map")
      .def_property_readonly("markers", &markerList, "list of MappedMarker, ordered by family and id")
      .def_property_readonly("frames", &MarkerMap::frames, "list of MappedFrame")
      .def(
          "find",
          [](const MarkerMap& map, const std::string& family, int id) {
            return map.find({family, id});
          },
          "family"_a, "id"_a, py::return_value_policy::copy, "MappedMarker or None")
      .def("add", &MarkerMap::add, "marker"_a,
           "Adds a marker. ValueError for invalid values, or a key or name that the map already contains.")
      .def("set", &MarkerMap::set, "marker"_a,
           "As add(), but replaces the marker with the same family and id.");
  bindParams<TextMapParams>(module, "TextMapParams",
                            "Properties of the markers that the plain text format does not contain.");
  module.def("read_marker_map", &readMarkerMap, "path"_a, "text"_a = TextMapParams(),
             "Reads YAML or the plain text format; RuntimeError 'file:line: reason'.");
  module.def("parse_marker_map", &parseMarkerMap, "content"_a, "path"_a, "text"_a = TextMapParams(),
             "Parses the content of a file as read_marker_map(); path: selects the format, and is named in "
             "errors.");
  module.def("write_marker_map", &writeMarkerMap, "map"_a, "path"_a, "text"_a = TextMapParams(),
             "Writes a map atomically, in the format of the file extension. text: parameters with which a "
             "plain text "
             "file will be read.");
}

}  // namespace
}  // namespace sextant

PYBIND11_MODULE(markers, module) {
  module.doc() = "Printed markers, their poses and maps.";
  py::module_::import("sextant._core.geometry");
  sextant::bindMarker(module);
  sextant::bindMarkerCorners(module);
  sextant::bindMarkerFamily(module);
  sextant::bindMarkerPose(module);
  sextant::bindMarkerMap(module);
}
