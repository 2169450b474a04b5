// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include "marker_casters.hpp"
#include "params.hpp"
#include "pose_casters.hpp"
#include "sextant/mapping/map_maker.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {
namespace {

void bindRecording(py::module_& module) {
  py::class_<RecordedInstant>(module, "RecordedInstant",
                              "What a robot's cameras saw at one instant of a drive.")
      .def(py::init([](std::vector<MarkerView> views, std::optional<Pose> T_odom_base, int drive) {
             return RecordedInstant{std::move(views), T_odom_base, drive};
           }),
           "views"_a, "T_odom_base"_a = py::none(), "drive"_a = 0)
      .def_readonly("views", &RecordedInstant::views)
      .def_readonly("T_odom_base", &RecordedInstant::T_odom_base)
      .def_readonly("drive", &RecordedInstant::drive);
  bindParams<MarkerSizes>(module, "MarkerSizes");
}

void bindMappingParams(py::module_& module) {
  bindParams<MappingParams>(module, "MappingParams").def_readwrite("odometry", &MappingParams::odometry);
}

void bindFindings(py::module_& module) {
  py::class_<SightingResidual>(module, "SightingResidual", "A sighting against the map that was made.")
      .def_property_readonly("instant", [](const SightingResidual& self) { return self.sighting.instant; })
      .def_property_readonly("view", [](const SightingResidual& self) { return self.sighting.view; })
      .def_property_readonly("detection",
                             [](const SightingResidual& self) { return self.sighting.detection; })
      .def_readonly("used", &SightingResidual::used)
      .def_readonly("squared_distance", &SightingResidual::squared_distance)
      .def_readonly("rms", &SightingResidual::rms, "pixels");
  py::class_<KnownMarkerCheck>(module, "KnownMarkerCheck",
                               "A marker that was known before, against what the recording says of it.")
      .def_property_readonly("family", [](const KnownMarkerCheck& self) { return self.key.family; })
      .def_property_readonly("id", [](const KnownMarkerCheck& self) { return self.key.id; })
      .def_readonly("offset", &KnownMarkerCheck::offset,
                    "(6) where all else sees it minus where it was known; metres, radians")
      .def_readonly("squared_distance", &KnownMarkerCheck::squared_distance)
      .def_readonly("wrong", &KnownMarkerCheck::wrong);
  py::class_<SecondPlace>(module, "SecondPlace",
                          "Sightings of a marker that agree with one another, but not with its place.")
      .def_property_readonly("family", [](const SecondPlace& self) { return self.key.family; })
      .def_property_readonly("id", [](const SecondPlace& self) { return self.key.id; })
      .def_readonly("T_map_marker", &SecondPlace::T_map_marker)
      .def_readonly("images", &SecondPlace::images)
      .def_property_readonly("witnesses", [](const SecondPlace& self) { return pairs(self.witnesses); });
}

void bindMapMaker(py::module_& module) {
  bindRecording(module);
  bindMappingParams(module);
  bindFindings(module);
  py::class_<MadeMap>(module, "MadeMap", "A map, and what it was made of.")
      .def_readonly("map", &MadeMap::map)
      .def_readonly("covariance", &MadeMap::covariance)
      .def_readonly("T_map_base", &MadeMap::T_map_base)
      .def_readonly("noise_scales", &MadeMap::noise_scales)
      .def_readonly("correlated_images", &MadeMap::correlated_images)
      .def_readonly("known_position_scale", &MadeMap::known_position_scale)
      .def_readonly("known_rotation_scale", &MadeMap::known_rotation_scale)
      .def_readonly("residuals", &MadeMap::residuals)
      .def_readonly("known", &MadeMap::known)
      .def_property_readonly("ambiguous", [](const MadeMap& self) { return pairs(self.ambiguous); })
      .def_property_readonly("unconnected", [](const MadeMap& self) { return pairs(self.unconnected); })
      .def_property_readonly("twice", [](const MadeMap& self) { return pairs(self.twice); })
      .def_readonly("second_places", &MadeMap::second_places);
  module.def("make_marker_map", &makeMarkerMap, "recording"_a, "sizes"_a, "known"_a, "params"_a,
             py::call_guard<py::gil_scoped_release>(),
             "MadeMap of a recording, a list of RecordedInstant in order of time.");
}

}  // namespace
}  // namespace sextant

PYBIND11_MODULE(mapping, module) {
  module.doc() = "Makes marker maps from recordings.";
  py::module_::import("sextant._core.geometry");
  py::module_::import("sextant._core.markers");
  py::module_::import("sextant._core.localization");
  sextant::bindMapMaker(module);
}
