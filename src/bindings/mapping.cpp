// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/stl.h>

#include "marker_casters.hpp"
#include "params.hpp"
#include "pose_casters.hpp"
#include "sextant/mapping/landmark_adjustment.hpp"
#include "sextant/mapping/map_maker.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {
namespace {

void bindRecording(py::module_& module) {
  py::class_<RecordedInstant>(module, "RecordedInstant",
                              "The detections of a robot's cameras at one instant.")
      .def(py::init([](std::vector<MarkerView> views, std::optional<Pose> T_odom_base, int drive) {
             return RecordedInstant{std::move(views), T_odom_base, drive};
           }),
           "views"_a, "T_odom_base"_a = py::none(), "drive"_a = 0)
      .def_readonly("views", &RecordedInstant::views, "list of MarkerView, at most one per camera")
      .def_readonly("T_odom_base", &RecordedInstant::T_odom_base, "(4, 4) odometry, or None")
      .def_readonly("drive", &RecordedInstant::drive, "index of the drive");
  bindParams<MarkerSizes>(module, "MarkerSizes", "Edge lengths of markers.");
}

void bindMappingParams(py::module_& module) {
  bindParams<MappingParams>(module, "MappingParams", "Parameters of make_marker_map().")
      .def_readwrite("odometry", &MappingParams::odometry, "OdometryParams");
}

void bindResiduals(py::module_& module) {
  py::class_<ObservationResidual>(module, "ObservationResidual",
                                  "Residuals of an observation against the map.")
      .def_property_readonly(
          "instant", [](const ObservationResidual& self) { return self.observation.instant; },
          "index of the instant")
      .def_property_readonly(
          "view", [](const ObservationResidual& self) { return self.observation.view; },
          "index of the image at the instant")
      .def_property_readonly(
          "detection", [](const ObservationResidual& self) { return self.observation.detection; },
          "index of the detection in the image")
      .def_readonly("used", &ObservationResidual::used, "False: outside the gate")
      .def_readonly("squared_distance", &ObservationResidual::squared_distance,
                    "sum of the squared residuals over their variances, x and y of four corners")
      .def_readonly("rms", &ObservationResidual::rms,
                    "root mean square residual of x and y of the four corners, pixels");
}

void bindFindings(py::module_& module) {
  py::class_<KnownMarkerCheck>(module, "KnownMarkerCheck",
                               "A previously known marker, compared with the recording.")
      .def_property_readonly(
          "family", [](const KnownMarkerCheck& self) { return self.key.family; }, "canonical family")
      .def_property_readonly(
          "id", [](const KnownMarkerCheck& self) { return self.key.id; }, "id in the family")
      .def_readonly(
          "offset", &KnownMarkerCheck::offset,
          "(6,) pose from the recording alone minus known pose: position, rotation in the map's axes; "
          "metres, radians")
      .def_readonly("squared_distance", &KnownMarkerCheck::squared_distance,
                    "the larger of the squared Mahalanobis distances of position and of rotation, each with "
                    "3 degrees of freedom")
      .def_readonly("wrong", &KnownMarkerCheck::wrong,
                    "contradicts the recording; the known pose was not used");
  py::class_<ConflictingPose>(
      module, "ConflictingPose",
      "A second pose of a marker, from observations that contradict its pose in the map.")
      .def_property_readonly(
          "family", [](const ConflictingPose& self) { return self.key.family; }, "canonical family")
      .def_property_readonly(
          "id", [](const ConflictingPose& self) { return self.key.id; }, "id in the family")
      .def_readonly("T_map_marker", &ConflictingPose::T_map_marker, "(4, 4) the second pose")
      .def_readonly("images", &ConflictingPose::images, "number of images that support it")
      .def_property_readonly(
          "witnesses", [](const ConflictingPose& self) { return pairs(self.witnesses); },
          "(family, id) of the other markers from which those images were located");
}

void bindResult(py::module_& module) {
  py::class_<MappingResult>(module, "MappingResult", "A map made from a recording, with diagnostics.")
      .def_readonly("map", &MappingResult::map, "MarkerMap with covariances")
      .def_readonly("covariance", &MappingResult::covariance,
                    "joint, in the order of map.markers, six rows per marker")
      .def_readonly("T_map_base", &MappingResult::T_map_base, "list of (4, 4) or None, one per instant")
      .def_readonly("noise_scales", &MappingResult::noise_scales,
                    "estimated factor on corner_sigma for each camera")
      .def_readonly("lens_errors", &MappingResult::lens_errors,
                    "estimated error of each camera's calibration: RMS displacement over its image, pixels")
      .def_readonly("correlated_images", &MappingResult::correlated_images,
                    "number of consecutive images that count as one")
      .def_readonly("known_position_scale", &MappingResult::known_position_scale,
                    "factor on the standard deviations of the known markers' positions")
      .def_readonly("known_rotation_scale", &MappingResult::known_rotation_scale,
                    "factor on the standard deviations of the known markers' rotations")
      .def_readonly("residuals", &MappingResult::residuals,
                    "list of ObservationResidual, of every observation of a mapped marker at a keyframe (an "
                    "image that differs "
                    "from those before) with a pose")
      .def_readonly("known", &MappingResult::known, "list of KnownMarkerCheck")
      .def_property_readonly(
          "ambiguous", [](const MappingResult& self) { return pairs(self.ambiguous); },
          "(family, id) of markers not in the map: two poses explain their observations, or none explains "
          "enough of them")
      .def_property_readonly(
          "unconnected", [](const MappingResult& self) { return pairs(self.unconnected); },
          "(family, id) of markers not in the map: no usable image or odometry connects them with the others")
      .def_property_readonly(
          "inconsistent", [](const MappingResult& self) { return pairs(self.inconsistent); },
          "(family, id) of markers not in the map: moved during the recording, or the id is used twice")
      .def_readonly("conflicting_poses", &MappingResult::conflicting_poses, "list of ConflictingPose");
}

void bindMapMaker(py::module_& module) {
  bindRecording(module);
  bindMappingParams(module);
  bindResiduals(module);
  bindFindings(module);
  bindResult(module);
  module.def(
      "make_marker_map", &makeMarkerMap, "recording"_a, "sizes"_a, "known"_a, "params"_a,
      py::call_guard<py::gil_scoped_release>(),
      "Makes a map; returns a MappingResult. recording: list of RecordedInstant in order of time; sizes: "
      "MarkerSizes of unknown markers; known: MarkerMap that defines the frame; if empty, the marker with "
      "the lowest family and id of the largest connected group is upright at the origin, facing along -y; "
      "with a floor, only its x, y and heading are fixed; params: MappingParams. "
      "RuntimeError if no marker can be located.");
}

void bindLandmarkDrives(py::module_& module) {
  py::class_<LandmarkDrives>(
      module, "LandmarkDrives",
      "What was measured on drives among landmarks, with the landmark of each observation.")
      .def(py::init([](const std::optional<Pose2>& first_pose, std::vector<Landmark2D> known,
                       const Eigen::MatrixXd& covariance) {
             return LandmarkDrives{{}, {}, first_pose, std::move(known), covariance};
           }),
           "first_pose"_a, "known"_a, "covariance"_a,
           "first_pose (3,) in the map, or None: unknown; known: first landmarks of the map, as they were "
           "known before; covariance of both")
      .def(
          "add_step",
          [](LandmarkDrives& self, size_t before, const OdometryStep& step, bool may_slip) {
            self.steps.push_back({before, step, may_slip});
          },
          "before"_a, "step"_a, "may_slip"_a = false,
          "Adds an OdometryStep from the pose with this index to the next; may_slip: the robot may have been "
          "carried away")
      .def(
          "add_sighting",
          [](LandmarkDrives& self, size_t pose, size_t landmark, const Observation2D& observation,
             const Pose2& T_base_sensor) {
            self.sightings.push_back({pose, landmark, observation, T_base_sensor});
          },
          "pose"_a, "landmark"_a, "observation"_a, "T_base_sensor"_a = Pose2{},
          "Adds an Observation2D, in the robot frame, of the landmark with this index");
}

void bindAdjustedLandmarks(py::module_& module) {
  py::class_<AdjustedLandmarks>(module, "AdjustedLandmarks", "Drives and map that were estimated together.")
      .def(py::init([](std::vector<Pose2> poses, std::vector<Landmark2D> landmarks, double scale,
                       double turn_scale, double bearing) {
             return AdjustedLandmarks{std::move(poses), std::move(landmarks), scale, turn_scale, bearing, {}};
           }),
           "poses"_a, "landmarks"_a, "scale"_a = 1.0, "turn_scale"_a = 1.0, "bearing"_a = 0.0)
      .def_readonly("poses", &AdjustedLandmarks::poses, "list of (3,) in the map")
      .def_readonly("landmarks", &AdjustedLandmarks::landmarks, "list of Landmark2D")
      .def_readonly("scale", &AdjustedLandmarks::scale, "as LandmarkFilter.scale")
      .def_readonly("turn_scale", &AdjustedLandmarks::turn_scale, "as LandmarkFilter.turn_scale")
      .def_readonly("bearing", &AdjustedLandmarks::bearing, "as LandmarkFilter.bearing, radians")
      .def_readonly("covariance", &AdjustedLandmarks::covariance,
                    "(n, n) of x, y, heading of the last pose, then x, y[, heading] of each landmark");
  module.def(
      "adjust_landmarks", &adjustLandmarks, "measured"_a, "params"_a, "begin"_a,
      py::call_guard<py::gil_scoped_release>(),
      "The most probable poses and landmarks of LandmarkDrives, AdjustedLandmarks; params: the "
      "LandmarkFilterParams whose standard deviations select the errors that are estimated; begin: where the "
      "search begins. RuntimeError: the observations do not determine all of them");
}

}  // namespace
}  // namespace sextant

PYBIND11_MODULE(mapping, module) {
  module.doc() = "Makes maps from recordings.";
  py::module_::import("sextant._core.geometry");
  py::module_::import("sextant._core.markers");
  py::module_::import("sextant._core.localization");
  py::module_::import("sextant._core.landmarks");
  sextant::bindMapMaker(module);
  sextant::bindLandmarkDrives(module);
  sextant::bindAdjustedLandmarks(module);
}
