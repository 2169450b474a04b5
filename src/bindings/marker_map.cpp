// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/marker_map.hpp"

#include "bindings.hpp"
#include "casters.hpp"
#include "sextant/markers/marker_map_file.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {
namespace {

MappedMarker makeMappedMarker(const std::string& family, int id, double size, const Pose& T_map_marker,
                              const std::string& name, const Matrix6d& covariance) {
  return {{family, id}, size, name, T_map_marker, covariance};
}

std::vector<MappedMarker> markerList(const MarkerMap& map) {
  std::vector<MappedMarker> markers;
  for (const auto& entry : map.markers()) markers.push_back(entry.second);
  return markers;
}

void bindEntries(py::module_& module) {
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

}  // namespace

void bindMarkerMap(py::module_& module) {
  bindEntries(module);
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
  py::class_<TextMapParams>(module, "TextMapParams",
                            "What the plain text format does not say of its markers.")
      .def(py::init<>())
      .def_readwrite("frame", &TextMapParams::frame)
      .def_readwrite("family", &TextMapParams::family)
      .def_readwrite("size", &TextMapParams::size)
      .def_readwrite("sizes", &TextMapParams::sizes)
      .def_readwrite("parents", &TextMapParams::parents)
      .def("validate", &TextMapParams::validate);
  module.def("read_marker_map", &readMarkerMap, "path"_a, "text"_a = TextMapParams(),
             "Reads YAML or the plain text format; RuntimeError 'file:line: reason'.");
  module.def(
      "write_marker_map", &writeMarkerMap, "map"_a, "path"_a, "text"_a = TextMapParams(),
      "Writes atomically; the ending tells the format, text what a plain text file will be read with.");
}

}  // namespace sextant
