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
  py::class_<Detection>(module, "Detection", "A marker found in an image.")
      .def(
          py::init([](const std::string& family, int id, const Corners& corners, const CornerSigmas& sigmas) {
            return Detection{{family, id}, corners, sigmas};
          }),
          "family"_a, "id"_a, "corners"_a, "corner_sigmas"_a = Detection().corner_sigmas)
      .def_property_readonly("family", [](const Detection& detection) { return detection.key.family; })
      .def_property_readonly("id", [](const Detection& detection) { return detection.key.id; })
      .def_readwrite("corners", &Detection::corners)
      .def_readwrite("corner_sigmas", &Detection::corner_sigmas,
                     "Four standard deviations of a corner's coordinates, pixels; -1: unknown.")
      .def_readonly("hamming", &Detection::hamming)
      .def_readonly("decision_margin", &Detection::decision_margin)
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
  module.def(
      "marker_corners",
      [](double size) {
        Eigen::Matrix<double, 4, 3> corners;
        for (int i = 0; i < 4; ++i) corners.row(i) = markerCorners(size)[i];
        return corners;
      },
      "size"_a,
      "Corners (4 x 3, metres) in the marker's frame: top left, top right, bottom right, bottom left.");
}

void bindMarkerFamily(py::module_& module) {
  module.def("marker_families", &markerFamilies, "Every family name that detectors and maps take.");
  module.def("canonical_family", &canonicalFamily, "name"_a, "One name per print.");
  module.def("family_size", &familySize, "name"_a, "Number of different markers in a family.");
  module.def(
      "marker_image",
      [](const std::string& family, int id) {
        const MarkerImage image = markerImage(family, id);
        return py::make_tuple(arrayFromImage(image.modules), image.border_begin, image.border_end);
      },
      "family"_a, "id"_a,
      "(modules, begin, end): uint8 picture, one pixel a module, and the rows and columns that the marker's "
      "size spans.");
}

void bindMarkerPose(py::module_& module) {
  py::class_<MarkerPose>(module, "MarkerPose")
      .def_readonly("T_camera_marker", &MarkerPose::T_camera_marker)
      .def_readonly("reprojection_error", &MarkerPose::reprojection_error, "RMS, pixels");
  py::class_<PlanarPoses>(module, "PlanarPoses", "Both poses that explain a square's four corners.")
      .def_readonly("best", &PlanarPoses::best)
      .def_readonly("alternative", &PlanarPoses::alternative)
      .def_property_readonly("ambiguity", &PlanarPoses::ambiguity);
  module.def("solve_marker_pose", &solveMarkerPose, "camera"_a, "corners"_a, "size"_a,
             "PlanarPoses of a marker with this edge length in metres, or None.");
  module.def(
      "marker_pose_covariance", &markerPoseCovariance, "camera"_a, "T_camera_marker"_a, "size"_a, "sigma"_a,
      "6 x 6, position and rotation in the optical frame's axes, from sigma pixels of noise; or None.");
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
  py::class_<MappedMarker>(module, "MappedMarker", "A marker whose place is known.")
      .def(py::init(&makeMappedMarker), "family"_a, "id"_a, "size"_a, "T_map_marker"_a, "name"_a = "",
           "covariance"_a = Matrix6d(Matrix6d::Zero()))
      .def_property_readonly("family", [](const MappedMarker& marker) { return marker.key.family; })
      .def_property_readonly("id", [](const MappedMarker& marker) { return marker.key.id; })
      .def_readonly("size", &MappedMarker::size)
      .def_readonly("name", &MappedMarker::name)
      .def_readonly("T_map_marker", &MappedMarker::T_map_marker)
      .def_readonly("covariance", &MappedMarker::covariance);
  py::class_<MappedFrame>(module, "MappedFrame", "A frame of the map file that is no marker.")
      .def_readonly("name", &MappedFrame::name)
      .def_readonly("parent", &MappedFrame::parent)
      .def_readonly("T_parent_frame", &MappedFrame::T_parent_frame);
}

void bindMarkerMap(py::module_& module) {
  bindMarkerMapEntries(module);
  py::class_<MarkerMap>(module, "MarkerMap", "Markers by family and id, in one frame.")
      .def(py::init<std::string>(), "frame"_a = "map")
      .def(py::init<const MarkerMap&>(), "other"_a, "A copy.")
      .def_property_readonly("frame", &MarkerMap::frame)
      .def_property_readonly("markers", &markerList)
      .def_property_readonly("frames", &MarkerMap::frames)
      .def(
          "find",
          [](const MarkerMap& map, const std::string& family, int id) {
            return map.find({family, id});
          },
          "family"_a, "id"_a, py::return_value_policy::copy, "MappedMarker or None")
      .def("add", &MarkerMap::add, "marker"_a,
           "Raises ValueError for what cannot be and what is there already.")
      .def("set", &MarkerMap::set, "marker"_a,
           "As add(), but replaces the marker with the same family and id.");
  bindParams<TextMapParams>(module, "TextMapParams",
                            "What the plain text format does not say of its markers.");
  module.def("read_marker_map", &readMarkerMap, "path"_a, "text"_a = TextMapParams(),
             "Reads YAML or the plain text format; RuntimeError 'file:line: reason'.");
  module.def(
      "write_marker_map", &writeMarkerMap, "map"_a, "path"_a, "text"_a = TextMapParams(),
      "Writes atomically; the ending tells the format, text what a plain text file will be read with.");
}

}  // namespace
}  // namespace sextant

PYBIND11_MODULE(markers, module) {
  module.doc() = "Printed markers, their poses and maps.";
  py::module_::import("sextant._core.geometry");
  sextant::bindMarker(module);
  sextant::bindMarkerFamily(module);
  sextant::bindMarkerPose(module);
  sextant::bindMarkerMap(module);
}
