// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/operators.h>
#include <pybind11/stl.h>

#include "params.hpp"
#include "pose_casters.hpp"
#include "sextant/landmarks/landmark_filter.hpp"
#include "sextant/landmarks/landmark_map_file.hpp"
#include "sextant/landmarks/landmark_slam.hpp"
#include "sextant/landmarks/landmark_timeline.hpp"
#include "sextant/landmarks/odometry_steps.hpp"
#include "sextant/landmarks/plane_sighting.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {
namespace {

void bindPlane(py::module_& module) {
  py::class_<PlaneLandmark>(module, "PlaneLandmark", "Something that stands in the plane, in the map frame.")
      .def(py::init([](const Eigen::Vector2d& position, const std::optional<double>& heading) {
             return PlaneLandmark{position, heading};
           }),
           "position"_a, "heading"_a = py::none())
      .def_readonly("position", &PlaneLandmark::position, "(2,) metres")
      .def_readonly("heading", &PlaneLandmark::heading, "radians, or None");
  py::class_<PlaneSighting>(module, "PlaneSighting", "What a sensor says of a landmark, in the robot frame.")
      .def(py::init([](const Eigen::Vector2d& position, const Eigen::MatrixXd& covariance,
                       const std::optional<double>& heading) {
             const Eigen::Index width = heading ? 3 : 2;
             if (covariance.rows() != width || covariance.cols() != width)
               throw std::invalid_argument("covariance must be " + std::to_string(width) + " x " +
                                           std::to_string(width));
             PlaneSighting sighting{position, heading, Eigen::Matrix3d::Zero()};
             sighting.covariance.topLeftCorner(width, width) = covariance;
             return sighting;
           }),
           "position"_a, "covariance"_a, "heading"_a = py::none(),
           "position (2,) metres; covariance (2, 2), or (3, 3) with a heading in radians")
      .def_readonly("position", &PlaneSighting::position, "(2,) metres")
      .def_readonly("heading", &PlaneSighting::heading, "radians, or None")
      .def_readonly("covariance", &PlaneSighting::covariance, "(3, 3) of x, y, heading");
}

void bindLabels(py::module_& module) {
  py::class_<LandmarkLabel>(module, "LandmarkLabel",
                            "What kind of thing, and which of them where a sighting tells.")
      .def(py::init<std::string, std::optional<int>>(), "class_name"_a, "id"_a = py::none())
      .def_readonly("class_name", &LandmarkLabel::class_name)
      .def_readonly("id", &LandmarkLabel::id, "of a printed marker, or None")
      .def(py::self == py::self)
      .def("__hash__",
           [](const LandmarkLabel& self) { return py::hash(py::make_tuple(self.class_name, self.id)); })
      .def("__repr__", [](const LandmarkLabel& self) {
        return "LandmarkLabel('" + self.class_name + "'" + (self.id ? ", " + std::to_string(*self.id) : "") +
               ")";
      });
  py::class_<LabelledSighting>(module, "LabelledSighting", "A sighting and what it is of.")
      .def(py::init<LandmarkLabel, PlaneSighting, bool>(), "label"_a, "sighting"_a, "begins"_a = true,
           "begins: whether it may be the first of a landmark")
      .def_readonly("label", &LabelledSighting::label)
      .def_readonly("sighting", &LabelledSighting::sighting)
      .def_readonly("begins", &LabelledSighting::begins);
}

void bindPlaneSighting(py::module_& module) {
  bindPlane(module);
  bindLabels(module);
}

void bindOdometrySteps(py::module_& module) {
  bindParams<OdometryNoiseParams>(
      module, "OdometryNoiseParams",
      "What a step of wheel odometry may be off by: deviations after a metre or a radian, "
      "that grow with the root.");
  module.def(
      "odometry_step_noise",
      [](const Pose2& step, const OdometryNoiseParams& params) { return noisyStep(step, params).noise; },
      "step"_a, "params"_a, "(3, 3) covariance of a small step (3,), felt where it begins");
}

void updateKnown(LandmarkFilter& self, const std::vector<size_t>& landmarks,
                 const std::vector<PlaneSighting>& sightings) {
  if (landmarks.size() != sightings.size()) throw std::invalid_argument("every sighting needs a landmark");
  std::vector<KnownSighting> seen;
  for (size_t i = 0; i < landmarks.size(); ++i) {
    if (landmarks[i] >= self.landmarks().size())
      throw py::index_error("there is no landmark " + std::to_string(landmarks[i]));
    seen.push_back({landmarks[i], sightings[i]});
  }
  self.update(seen);
}

void bindLandmarkFilterParams(py::module_& module) {
  bindParams<LandmarkFilterParams>(module, "LandmarkFilterParams");
}

void bindLandmarkFilter(py::module_& module) {
  bindLandmarkFilterParams(module);
  py::class_<LandmarkFilter>(
      module, "LandmarkFilter",
      "Simultaneous localization and mapping in the plane by an unscented Kalman filter. Poses "
      "are (3,) x, y, heading: metres, radians.")
      .def(py::init<const LandmarkFilterParams&, const Pose2&, const Eigen::Matrix3d&>(), "params"_a,
           "pose"_a, "covariance"_a, "covariance (3, 3) of the pose, map's axes, positive definite")
      .def(
          "predict",
          [](LandmarkFilter& self, const Pose2& step, const Eigen::Matrix3d& noise, double duration) {
            self.predict({step, noise, step.position.norm()}, duration);
          },
          "step"_a, "noise"_a, "duration"_a = 0.0,
          "step (3,) in the robot's frame where it begins, and there noise (3, 3) is felt; seconds")
      .def("update", &updateKnown, "landmarks"_a, "sightings"_a,
           "sightings of one moment, and the index of each one's landmark")
      .def("add", &LandmarkFilter::add, "sighting"_a, "index of a new landmark")
      .def_property_readonly("pose", &LandmarkFilter::pose)
      .def_property_readonly("landmarks", &LandmarkFilter::landmarks)
      .def_property_readonly(
          "covariance", [](const LandmarkFilter& self) { return self.covariance(); },
          "(n, n) of x, y, heading and all landmarks, map's axes")
      .def_property_readonly(
          "pose_covariance",
          [](const LandmarkFilter& self) { return self.covariance(std::vector<size_t>{}); }, "(3, 3)")
      .def_property_readonly("scale", &LandmarkFilter::scale,
                             "of odometry; what it measures is multiplied by it")
      .def_property_readonly("clock_offset", &LandmarkFilter::clockOffset,
                             "seconds to add to stamps of sightings")
      .def_property_readonly("scale_variance", &LandmarkFilter::scaleVariance,
                             "0: the scale is not estimated")
      .def_property_readonly("clock_variance", &LandmarkFilter::clockVariance,
                             "of clock_offset, squared seconds; 0: it is not estimated")
      .def_property_readonly("nis", &LandmarkFilter::nis, "normalized innovation squared of the last update")
      .def_property_readonly("nis_width", &LandmarkFilter::nisWidth, "its degrees of freedom")
      .def_property_readonly("repairs", &LandmarkFilter::repairs,
                             "of covariances that rounding made indefinite");
}

void bindLandmarkSlamParams(py::module_& module) {
  bindParams<AssociationParams>(module, "AssociationParams",
                                "How sightings are told to be of known landmarks.");
  bindParams<CandidateParams>(module, "CandidateParams",
                              "When something that is seen is taken for a landmark.");
}

void bindSensorParams(py::module_& module) {
  bindParams<LandmarkSensorParams>(module, "LandmarkSensorParams", "What a sensor sees, and how surely.");
  bindParams<LandmarkMatchingParams>(module, "LandmarkMatchingParams",
                                     "How a lost robot finds itself in a map.");
}

void bindSlamParams(py::module_& module) {
  bindParams<LandmarkSlamParams>(module, "LandmarkSlamParams")
      .def_readwrite("filter", &LandmarkSlamParams::filter)
      .def_readwrite("association", &LandmarkSlamParams::association)
      .def_readwrite("candidates", &LandmarkSlamParams::candidates)
      .def_readwrite("sensor", &LandmarkSlamParams::sensor)
      .def_readwrite("matching", &LandmarkSlamParams::matching);
}

void bindLandmarkSlamReport(py::module_& module) {
  py::class_<LandmarkReport>(module, "LandmarkReport", "What became of the sightings of a moment.")
      .def_readonly("known", &LandmarkReport::known)
      .def_readonly("begun", &LandmarkReport::begun)
      .def_readonly("doubtful", &LandmarkReport::doubtful)
      .def_readonly("waiting", &LandmarkReport::waiting)
      .def_readonly("rejected", &LandmarkReport::rejected)
      .def_readonly("merged", &LandmarkReport::merged)
      .def_readonly("removed", &LandmarkReport::removed)
      .def_readonly("lost", &LandmarkReport::lost)
      .def_readonly("nis", &LandmarkReport::nis)
      .def_readonly("nis_width", &LandmarkReport::nis_width)
      .def_readonly("keys", &LandmarkReport::keys, "key of each sighting's landmark, or None");
}

void bindLandmarkSlam(py::module_& module) {
  bindLandmarkSlamParams(module);
  bindSensorParams(module);
  bindSlamParams(module);
  bindLandmarkSlamReport(module);
  py::class_<LandmarkSlam>(module, "LandmarkSlam",
                           "Localization and mapping with landmarks that come, are found to be one, and go.")
      .def(py::init<const LandmarkSlamParams&, const Pose2&, const Eigen::Matrix3d&>(), "params"_a, "pose"_a,
           "covariance"_a, "pose (3,); covariance (3, 3) of it, map's axes, positive definite")
      .def(py::init<const LandmarkSlam&>(), "other"_a)
      .def(
          "predict",
          [](LandmarkSlam& self, const Pose2& step, const Eigen::Matrix3d& noise, double duration) {
            self.predict({step, noise, step.position.norm()}, duration);
          },
          "step"_a, "noise"_a, "duration"_a = 0.0, "as LandmarkFilter.predict()")
      .def("see", &LandmarkSlam::see, "stamp"_a, "sightings"_a, "T_base_sensor"_a = Pose2{},
           "LandmarkReport of all LabelledSighting of one moment, seconds")
      .def_property_readonly("filter", &LandmarkSlam::filter, py::return_value_policy::reference_internal)
      .def_property_readonly("labels", &LandmarkSlam::labels,
                             "LandmarkLabel of each of the filter's landmarks")
      .def_property_readonly("keys", &LandmarkSlam::keys, "a number of each, the same as long as it lives")
      .def_property_readonly("candidates", &LandmarkSlam::candidates, "number of what may become landmarks")
      .def_property_readonly("is_lost", &LandmarkSlam::isLost)
      .def("lose", &LandmarkSlam::lose, "where the robot is is not known any more")
      .def("set_pose", &LandmarkSlam::setPose, "pose"_a, "covariance"_a)
      .def("set_map", &LandmarkSlam::setMap, "pose"_a, "landmarks"_a, "labels"_a, "covariance"_a,
           "covariance (n, n) of x, y, heading of the robot and then x, y[, heading] of the landmarks");
}

void bindLandmarkTimelineParts(py::module_& module) {
  bindParams<LandmarkTimelineParams>(module, "LandmarkTimelineParams")
      .def_readwrite("odometry", &LandmarkTimelineParams::odometry);
  py::enum_<Arrival>(module, "Arrival", "What became of sightings.")
      .value("TAKEN", Arrival::taken)
      .value("WAITING", Arrival::waiting, "for odometry of their moment")
      .value("TOO_LATE", Arrival::too_late)
      .value("DUPLICATE", Arrival::duplicate);
  py::class_<LandmarkTimeline::Applied>(module, "LandmarkApplied", "Sightings that came into the estimate.")
      .def_readonly("stamp", &LandmarkTimeline::Applied::stamp, "that they came with, seconds")
      .def_readonly("report", &LandmarkTimeline::Applied::report);
  py::class_<LandmarkTimeline::Now>(module, "LandmarkNow", "The robot at the last odometry.")
      .def_readonly("stamp", &LandmarkTimeline::Now::stamp, "seconds")
      .def_readonly("pose", &LandmarkTimeline::Now::T_map_base)
      .def_readonly("covariance", &LandmarkTimeline::Now::covariance, "(3, 3) of x, y, heading, map's axes")
      .def_readonly("T_map_odom", &LandmarkTimeline::Now::T_map_odom);
}

void bindLandmarkTimeline(py::module_& module) {
  bindLandmarkTimelineParts(module);
  py::class_<LandmarkTimeline>(
      module, "LandmarkTimeline",
      "Runs a LandmarkSlam on odometry and sightings that come late, twice, or out of order.")
      .def(py::init<const LandmarkTimelineParams&, const LandmarkSlam&>(), "params"_a, "slam"_a)
      .def("odometry", &LandmarkTimeline::odometry, "stamp"_a, "T_odom_base"_a,
           "False: it is not newer than the last one")
      .def("see", &LandmarkTimeline::see, "stamp"_a, "sightings"_a, "T_base_sensor"_a = Pose2{},
           "Arrival of what a sensor saw at one moment, in the robot frame")
      .def_property_readonly("now", &LandmarkTimeline::now, "LandmarkNow, or None before the first odometry")
      .def_property_readonly("slam", &LandmarkTimeline::slam, py::return_value_policy::copy,
                             "as it was after the newest sightings")
      .def_property_readonly("applied", &LandmarkTimeline::applied,
                             "[LandmarkApplied] that the last odometry() or see() brought in")
      .def_property_readonly("leaps", &LandmarkTimeline::leaps,
                             "how often odometry leapt farther than anything drives: it begins anew then")
      .def_property_readonly("is_lost", [](const LandmarkTimeline& self) { return self.slam().isLost(); })
      .def("lose", [](LandmarkTimeline& self) { self.change([](LandmarkSlam& slam) { slam.lose(); }); })
      .def(
          "set_pose",
          [](LandmarkTimeline& self, const Pose2& pose, const Eigen::Matrix3d& covariance) {
            self.change([&](LandmarkSlam& slam) { slam.setPose(pose, covariance); });
          },
          "pose"_a, "covariance"_a, "at the last odometry")
      .def(
          "set_map",
          [](LandmarkTimeline& self, const Pose2& pose, const std::vector<PlaneLandmark>& landmarks,
             const std::vector<LandmarkLabel>& labels, const Eigen::MatrixXd& covariance) {
            self.change([&](LandmarkSlam& slam) { slam.setMap(pose, landmarks, labels, covariance); });
          },
          "pose"_a, "landmarks"_a, "labels"_a, "covariance"_a)
      .def("restart", &LandmarkTimeline::restart,
           "odometry and all that was seen are forgotten, the map is not");
}

void bindLandmarkMapFile(py::module_& module) {
  py::class_<LandmarkMap>(module, "LandmarkMap",
                          "Landmarks with all that is known of them, and of where the robot was.")
      .def(py::init([](const std::string& frame, const Pose2& pose,
                       const std::vector<PlaneLandmark>& landmarks, const std::vector<LandmarkLabel>& labels,
                       const Eigen::MatrixXd& covariance, bool is_lost) {
             LandmarkMap map{frame, pose, landmarks, labels, covariance, is_lost};
             map.validate();
             return map;
           }),
           "frame"_a, "pose"_a, "landmarks"_a, "labels"_a, "covariance"_a, "is_lost"_a = false)
      .def_readonly("frame", &LandmarkMap::frame)
      .def_readonly("pose", &LandmarkMap::T_map_base, "(3,) of the robot")
      .def_readonly("landmarks", &LandmarkMap::landmarks)
      .def_readonly("labels", &LandmarkMap::labels)
      .def_readonly("covariance", &LandmarkMap::covariance,
                    "(n, n) of the robot's x, y, heading, then the landmarks'")
      .def_readonly("is_lost", &LandmarkMap::is_lost, "the robot is not where pose says");
  module.def("read_landmark_map", &readLandmarkMap, "path"_a);
  module.def("write_landmark_map", &writeLandmarkMap, "landmark_map"_a, "path"_a);
}

}  // namespace
}  // namespace sextant

PYBIND11_MODULE(landmarks, module) {
  module.doc() = "Localization and mapping with landmarks in the plane.";
  sextant::bindPlaneSighting(module);
  sextant::bindOdometrySteps(module);
  sextant::bindLandmarkFilter(module);
  sextant::bindLandmarkSlam(module);
  sextant::bindLandmarkTimeline(module);
  sextant::bindLandmarkMapFile(module);
}
