// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/numpy.h>
#include <pybind11/operators.h>
#include <pybind11/stl.h>

#include "params.hpp"
#include "pose_casters.hpp"
#include "sextant/landmarks/landmark_filter.hpp"
#include "sextant/landmarks/landmark_map_file.hpp"
#include "sextant/landmarks/landmark_slam.hpp"
#include "sextant/landmarks/landmark_timeline.hpp"
#include "sextant/landmarks/observation_2d.hpp"
#include "sextant/landmarks/odometry_history.hpp"
#include "sextant/landmarks/odometry_noise.hpp"
#include "sextant/landmarks/source_monitor.hpp"

namespace py = pybind11;
using namespace py::literals;

namespace sextant {
namespace {

void bindLandmarks2D(py::module_& module) {
  py::class_<Landmark2D>(module, "Landmark2D", "A landmark in the plane, in the map frame.")
      .def(py::init([](const Eigen::Vector2d& position, const std::optional<double>& heading) {
             return Landmark2D{position, heading};
           }),
           "position"_a, "heading"_a = py::none(), "position (2,) metres; heading in radians, or None")
      .def_readonly("position", &Landmark2D::position, "(2,) metres")
      .def_readonly("heading", &Landmark2D::heading, "radians, or None");
  py::class_<Observation2D>(module, "Observation2D", "A measurement of a landmark in the robot frame.")
      .def(py::init([](const Eigen::Vector2d& position, const Eigen::MatrixXd& covariance,
                       const std::optional<double>& heading) {
             const Eigen::Index width = heading ? 3 : 2;
             if (covariance.rows() != width || covariance.cols() != width)
               throw std::invalid_argument("covariance must be " + std::to_string(width) + " x " +
                                           std::to_string(width));
             Observation2D observation{position, heading, Eigen::Matrix3d::Zero()};
             observation.covariance.topLeftCorner(width, width) = covariance;
             return observation;
           }),
           "position"_a, "covariance"_a, "heading"_a = py::none(),
           "position (2,) metres; covariance (2, 2), or (3, 3) with a heading in radians")
      .def_readonly("position", &Observation2D::position, "(2,) metres")
      .def_readonly("heading", &Observation2D::heading, "radians, or None")
      .def_readonly("covariance", &Observation2D::covariance, "(3, 3) of x, y, heading")
      .def(py::pickle(
          [](const Observation2D& self) {
            return py::make_tuple(self.position, self.heading, self.covariance);
          },
          [](const py::tuple& state) {
            return Observation2D{state[0].cast<Eigen::Vector2d>(), state[1].cast<std::optional<double>>(),
                                 state[2].cast<Eigen::Matrix3d>()};
          }));
}

void bindLabels(py::module_& module) {
  py::class_<LandmarkLabel>(module, "LandmarkLabel", "Class of a landmark, and its id if it can be observed.")
      .def(py::init<std::string, std::optional<int>>(), "class_name"_a, "id"_a = py::none(),
           "id of a printed marker, or None")
      .def_readonly("class_name", &LandmarkLabel::class_name, "for instance blue_pillar, or a marker family")
      .def_readonly("id", &LandmarkLabel::id, "of a printed marker, or None")
      .def(py::self == py::self)
      .def("__hash__",
           [](const LandmarkLabel& self) { return py::hash(py::make_tuple(self.class_name, self.id)); })
      .def("__repr__",
           [](const LandmarkLabel& self) {
             return "LandmarkLabel('" + self.class_name + "'" +
                    (self.id ? ", " + std::to_string(*self.id) : "") + ")";
           })
      .def(py::pickle(
          [](const LandmarkLabel& self) { return py::make_tuple(self.class_name, self.id); },
          [](const py::tuple& state) {
            return LandmarkLabel{state[0].cast<std::string>(), state[1].cast<std::optional<int>>()};
          }));
  py::class_<LabelledObservation>(module, "LabelledObservation",
                                  "An observation with the label of its landmark.")
      .def(py::init<LandmarkLabel, Observation2D, bool>(), "label"_a, "observation"_a,
           "can_initialize"_a = true, "can_initialize: whether it may initialize a landmark")
      .def_readonly("label", &LabelledObservation::label, "LandmarkLabel")
      .def_readonly("observation", &LabelledObservation::observation, "Observation2D")
      .def_readonly("can_initialize", &LabelledObservation::can_initialize,
                    "whether it may initialize a landmark")
      .def(py::pickle(
          [](const LabelledObservation& self) {
            return py::make_tuple(self.label, self.observation, self.can_initialize);
          },
          [](const py::tuple& state) {
            return LabelledObservation{state[0].cast<LandmarkLabel>(), state[1].cast<Observation2D>(),
                                       state[2].cast<bool>()};
          }));
}

void bindObservations(py::module_& module) {
  bindLandmarks2D(module);
  bindLabels(module);
  module.def("log_density", py::vectorize(logDensity), "distance"_a, "root_determinant"_a,
             "Logarithm of the density of an observation, 1/m^2, with a share of gross errors: squared "
             "Mahalanobis distance, square root of the determinant of its covariance, m^2");
}

void bindOdometrySteps(py::module_& module) {
  bindParams<OdometryNoiseParams>(module, "OdometryNoiseParams",
                                  "Noise of wheel odometry: standard deviations after a metre or a radian, "
                                  "growing with the square root of distance or angle.");
  module.def(
      "odometry_step_noise",
      [](const Pose2& step, const OdometryNoiseParams& params) { return noisyStep(step, params).noise; },
      "step"_a, "params"_a,
      "Covariance (3, 3) of a short step (3,) x, y, heading, in the frame at its beginning");
  py::class_<OdometryStep>(module, "OdometryStep", "A motion of the robot with its noise.")
      .def_readonly("step", &OdometryStep::step, "(3,) x, y, heading in the frame at its beginning")
      .def_readonly("noise", &OdometryStep::noise, "covariance (3, 3), in the frame at its beginning")
      .def_readonly("distance", &OdometryStep::distance, "metres driven")
      .def_readonly("turn", &OdometryStep::turn, "radians turned, not wrapped");
  py::class_<OdometryHistory>(module, "OdometryHistory", "Odometry readings.")
      .def(py::init<const OdometryNoiseParams&, double>(), "params"_a, "span"_a,
           "span: seconds of readings that are kept")
      .def("add", &OdometryHistory::add, "stamp"_a, "T_odom_base"_a,
           "Adds a pose (3,), stamp in seconds; False: ignored, it is not newer than the last one")
      .def("at", &OdometryHistory::at, "stamp"_a, "Interpolated pose (3,), or None: outside of the readings")
      .def("between", &OdometryHistory::between, "begin"_a, "end"_a,
           "OdometryStep between two stamps, or None: one is outside of the readings");
}

void updateKnown(LandmarkFilter& self, const std::vector<size_t>& landmarks,
                 const std::vector<Observation2D>& observations) {
  if (landmarks.size() != observations.size())
    throw std::invalid_argument("landmarks and observations differ in length");
  std::vector<AssociatedObservation> seen;
  for (size_t i = 0; i < landmarks.size(); ++i) {
    if (landmarks[i] >= self.landmarks().size())
      throw py::index_error("there is no landmark " + std::to_string(landmarks[i]));
    seen.push_back({landmarks[i], observations[i]});
  }
  self.update(seen);
}

void bindLandmarkFilterParams(py::module_& module) {
  bindParams<LandmarkFilterParams>(module, "LandmarkFilterParams", "Parameters of LandmarkFilter.");
}

py::class_<LandmarkFilter> bindLandmarkFilterState(py::module_& module) {
  return py::class_<LandmarkFilter>(module, "LandmarkFilter",
                                    "Planar SLAM with an unscented Kalman filter and known data association. "
                                    "Poses are (3,) x, y, heading: metres, radians.")
      .def(py::init<const LandmarkFilterParams&, const Pose2&, const Eigen::Matrix3d&>(), "params"_a,
           "pose"_a, "covariance"_a,
           "pose (3,); covariance (3, 3) in the map frame. Raises ValueError if it is not positive definite")
      .def(
          "predict",
          [](LandmarkFilter& self, const Pose2& step, const Eigen::Matrix3d& noise, double duration) {
            self.predict({step, noise, step.position.norm(), step.heading}, duration);
          },
          "step"_a, "noise"_a, "duration"_a = 0.0,
          "Moves the robot by a step (3,) with noise (3, 3), both in the robot frame at its beginning, that "
          "took duration seconds")
      .def("update", &updateKnown, "landmarks"_a, "observations"_a,
           "Corrects the state with one scan: the landmark index of each observation, and the list of "
           "Observation2D")
      .def("add", &LandmarkFilter::add, "observation"_a,
           "Initializes a landmark from an Observation2D and returns its index")
      .def_property_readonly("pose", &LandmarkFilter::pose, "(3,) of the robot in the map")
      .def_property_readonly("landmarks", &LandmarkFilter::landmarks, "list of Landmark2D")
      .def_property_readonly(
          "covariance", [](const LandmarkFilter& self) { return self.covariance(); },
          "(n, n) of x, y, heading and all landmarks, in the map frame")
      .def_property_readonly(
          "pose_covariance",
          [](const LandmarkFilter& self) { return self.covariance(std::vector<size_t>{}); },
          "(3, 3) of x, y, heading, in the map frame");
}

void bindLandmarkFilter(py::module_& module) {
  bindLandmarkFilterParams(module);
  bindLandmarkFilterState(module)
      .def_property_readonly("scale", &LandmarkFilter::scale,
                             "estimated factor by which the distances of odometry are multiplied")
      .def_property_readonly("turn_scale", &LandmarkFilter::turnScale,
                             "estimated factor by which the angles of odometry are multiplied")
      .def_property_readonly("clock_offset", &LandmarkFilter::clockOffset,
                             "seconds to add to the stamps of observations")
      .def_property_readonly("bearing", &LandmarkFilter::bearing,
                             "radians to add to the bearings of observations")
      .def_property_readonly("scale_variance", &LandmarkFilter::scaleVariance,
                             "variance of scale; 0: not estimated")
      .def_property_readonly("turn_scale_variance", &LandmarkFilter::turnScaleVariance,
                             "variance of turn_scale; 0: not estimated")
      .def_property_readonly("bearing_variance", &LandmarkFilter::bearingVariance,
                             "variance of bearing, square radians; 0: not estimated")
      .def_property_readonly("clock_variance", &LandmarkFilter::clockVariance,
                             "variance of clock_offset, square seconds; 0: not estimated")
      .def_property_readonly("nis", &LandmarkFilter::nis, "normalized innovation squared of the last update")
      .def_property_readonly("nis_dof", &LandmarkFilter::nisDof, "degrees of freedom of nis")
      .def_property_readonly(
          "repairs", &LandmarkFilter::repairs,
          "number of times that a covariance was repaired because rounding had made it indefinite");
}

void bindLandmarkSlamParams(py::module_& module) {
  bindParams<AssociationParams>(module, "AssociationParams", "Parameters of the data association.");
  bindParams<CandidateParams>(module, "CandidateParams",
                              "Conditions under which repeated observations become a landmark.");
}

void bindSensorParams(py::module_& module) {
  bindParams<LandmarkSensorParams>(module, "LandmarkSensorParams",
                                   "Field of view and detection model of a sensor.");
  bindParams<LandmarkMapMatchingParams>(module, "LandmarkMapMatchingParams",
                                        "Parameters of the relocalization of a lost robot in its map.");
}

void bindSlamParams(py::module_& module) {
  bindParams<LandmarkSlamParams>(module, "LandmarkSlamParams", "Parameters of LandmarkSlam.")
      .def_readwrite("filter", &LandmarkSlamParams::filter, "LandmarkFilterParams")
      .def_readwrite("association", &LandmarkSlamParams::association, "AssociationParams")
      .def_readwrite("candidates", &LandmarkSlamParams::candidates, "CandidateParams")
      .def_readwrite("sensor", &LandmarkSlamParams::sensor, "LandmarkSensorParams")
      .def_readwrite("matching", &LandmarkSlamParams::matching, "LandmarkMapMatchingParams");
}

void bindLandmarkSlamReport(py::module_& module) {
  py::class_<LandmarkReport>(module, "LandmarkReport", "Result of one scan.")
      .def_readonly("associated", &LandmarkReport::associated, "observations of landmarks in the map")
      .def_readonly("initialized", &LandmarkReport::initialized, "observations that initialized a landmark")
      .def_readonly("ambiguous", &LandmarkReport::ambiguous,
                    "observations not used: ambiguous, or an id that occurs twice in the scan")
      .def_readonly("tentative", &LandmarkReport::tentative,
                    "observations of candidates; all observations while the robot is lost")
      .def_readonly("rejected", &LandmarkReport::rejected,
                    "observations with an id, outside of the gate of the landmark with this id")
      .def_readonly("excluded", &LandmarkReport::excluded,
                    "observations not applied, as they contradict the pose and their source is wrong")
      .def_readonly("merged", &LandmarkReport::merged, "landmarks merged with another one")
      .def_readonly("removed", &LandmarkReport::removed, "landmarks removed")
      .def_readonly("lost", &LandmarkReport::lost, "whether the robot is lost")
      .def_readonly("nis", &LandmarkReport::nis, "normalized innovation squared of the update")
      .def_readonly("nis_dof", &LandmarkReport::nis_dof, "degrees of freedom of nis; 0: no update")
      .def_readonly("keys", &LandmarkReport::keys, "key of the landmark of each observation, or None");
}

py::class_<LandmarkSlam> bindLandmarkSlamState(py::module_& module) {
  return py::class_<LandmarkSlam>(
             module, "LandmarkSlam",
             "SLAM with data association: initializes, merges and removes landmarks, and relocalizes a lost "
             "robot.")
      .def_property_readonly("filter", &LandmarkSlam::filter, py::return_value_policy::reference_internal,
                             "LandmarkFilter")
      .def_property_readonly("labels", &LandmarkSlam::labels,
                             "LandmarkLabel of each of the filter's landmarks")
      .def_property_readonly("keys", &LandmarkSlam::keys, "key of each landmark, constant while it exists")
      .def_property_readonly("candidates", &LandmarkSlam::candidates, "number of landmark candidates")
      .def_property_readonly(
          "odometry_noise_factor", [](const LandmarkSlam& slam) { return slam.noise().odometry(); },
          "estimated factor by which the variances of odometry are too small")
      .def_property_readonly(
          "observation_noise_factor", [](const LandmarkSlam& slam) { return slam.noise().observations(); },
          "estimated factor by which the variances of observations are too small")
      .def_property_readonly("is_lost", &LandmarkSlam::isLost, "whether the pose is unknown");
}

void bindLandmarkSlam(py::module_& module) {
  bindLandmarkSlamParams(module);
  bindSensorParams(module);
  bindSlamParams(module);
  bindLandmarkSlamReport(module);
  bindLandmarkSlamState(module)
      .def(py::init<const LandmarkSlamParams&, const Pose2&, const Eigen::Matrix3d&>(), "params"_a, "pose"_a,
           "covariance"_a,
           "pose (3,); covariance (3, 3) in the map frame. Raises ValueError if it is not positive definite")
      .def(py::init<const LandmarkSlam&>(), "other"_a, "copies it")
      .def(
          "predict",
          [](LandmarkSlam& self, const Pose2& step, const Eigen::Matrix3d& noise, double duration) {
            self.predict({step, noise, step.position.norm(), step.heading}, duration);
          },
          "step"_a, "noise"_a, "duration"_a = 0.0, "Moves the robot, as LandmarkFilter.predict()")
      .def("observe",
           py::overload_cast<double, const std::vector<LabelledObservation>&, const Pose2&>(
               &LandmarkSlam::observe),
           "stamp"_a, "observations"_a, "T_base_sensor"_a = Pose2{},
           "Applies one scan of one sensor, a list of LabelledObservation with its stamp in seconds, and "
           "returns a LandmarkReport")
      .def("relocalize", &LandmarkSlam::relocalize,
           "Discards the pose: the robot is lost until it is relocalized in its map")
      .def("set_pose", &LandmarkSlam::setPose, "pose"_a, "covariance"_a,
           "Replaces the pose (3,) and its covariance (3, 3)")
      .def("set_map", &LandmarkSlam::setMap, "pose"_a, "landmarks"_a, "labels"_a, "covariance"_a,
           "Replaces pose and map; covariance (n, n) of x, y, heading of the robot, then x, y[, heading] of "
           "each landmark");
}

void bindLandmarkTimelineParts(py::module_& module) {
  bindParams<LandmarkTimelineParams>(module, "LandmarkTimelineParams", "Parameters of LandmarkTimeline.")
      .def_readwrite("odometry", &LandmarkTimelineParams::odometry, "OdometryNoiseParams");
  py::enum_<Detects>(module, "Detects", "What a sensor detects.")
      .value("ALL", Detects::all, "all landmarks in view")
      .value("WITH_ID", Detects::with_id, "only landmarks with an id, for instance printed markers");
  py::enum_<Arrival>(module, "Arrival", "What is done with a scan when it arrives.")
      .value("APPLIED", Arrival::applied, "applied at its own stamp")
      .value("WAITING", Arrival::waiting, "waits for odometry of its stamp")
      .value("TOO_LATE", Arrival::too_late, "delayed by more than the lag, or older than the first odometry")
      .value("DUPLICATE", Arrival::duplicate, "received before")
      .value("TOO_LARGE", Arrival::too_large, "more observations than max_observations");
  py::enum_<PlaceUse>(module, "PlaceUse",
                      "What is done with the places at which an image may have been taken.")
      .value("UNUSED", PlaceUse::unused, "the place is probably unknown")
      .value("AGREES", PlaceUse::agrees, "the pose is at one of the probable places")
      .value("CONTRADICTS", PlaceUse::contradicts, "the pose is at another place")
      .value("RELOCALIZED", PlaceUse::relocalized, "the pose is now one of these places");
  py::class_<LandmarkTimeline::Applied>(module, "AppliedScan", "A scan that was applied.")
      .def_readonly("stamp", &LandmarkTimeline::Applied::stamp, "seconds, as received")
      .def_readonly("report", &LandmarkTimeline::Applied::report, "LandmarkReport of a scan")
      .def_readonly("places", &LandmarkTimeline::Applied::places, "PlaceUse of an image, or None");
  py::class_<LandmarkTimeline::Now>(module, "LandmarkEstimate", "Pose of the robot at the newest odometry.")
      .def_readonly("stamp", &LandmarkTimeline::Now::stamp, "seconds")
      .def_readonly("pose", &LandmarkTimeline::Now::T_map_base, "(3,) in the map")
      .def_readonly("covariance", &LandmarkTimeline::Now::covariance,
                    "(3, 3) of x, y, heading, in the map frame")
      .def_readonly("T_map_odom", &LandmarkTimeline::Now::T_map_odom, "(3,); constant between scans");
}

py::class_<LandmarkTimeline> bindLandmarkTimelineState(py::module_& module) {
  return py::class_<LandmarkTimeline>(
             module, "LandmarkTimeline",
             "Runs LandmarkSlam on scans that arrive late, twice or out of order, each at its own stamp.")
      .def(py::init<const LandmarkTimelineParams&, const LandmarkSlam&>(), "params"_a, "slam"_a,
           "slam is copied")
      .def("odometry", &LandmarkTimeline::odometry, "stamp"_a, "T_odom_base"_a,
           "Adds an odometry pose (3,), stamp in seconds; False: ignored, it is not newer than the last one")
      .def("observe", &LandmarkTimeline::observe, "stamp"_a, "observations"_a, "T_base_sensor"_a = Pose2{},
           "detects"_a = Detects::all,
           "Adds one scan, a list of LabelledObservation with its stamp in seconds, and returns its Arrival; "
           "detects: what the sensor detects, Detects")
      .def(
          "observe_places",
          [](LandmarkTimeline& self, double stamp,
             const std::vector<std::tuple<Pose2, Eigen::Matrix3d, double>>& places) {
            std::vector<PossiblePose> poses;
            for (const auto& [pose, covariance, probability] : places)
              poses.push_back({pose, covariance, probability});
            return self.observePlaces(stamp, poses);
          },
          "stamp"_a, "places"_a,
          "Adds the recognized places of an image with its stamp in seconds: (pose (3,), covariance (3, 3), "
          "probability) of each; the rest of the probability is that of an unknown place. Returns its "
          "Arrival")
      .def_property_readonly("now", &LandmarkTimeline::now,
                             "LandmarkEstimate, or None before the first odometry")
      .def_property_readonly(
          "hypotheses", [](const LandmarkTimeline& self) { return self.hypotheses().size(); },
          "number of states that are kept while a decision is open")
      .def_property_readonly("slam", &LandmarkTimeline::slam, py::return_value_policy::copy,
                             "copy of the LandmarkSlam after the newest scan")
      .def_property_readonly(
          "applied", &LandmarkTimeline::applied,
          "list of AppliedScan: scans that the last odometry() or observe() applied for the first time")
      .def_property_readonly(
          "jumps", &LandmarkTimeline::jumps,
          "number of odometry jumps larger than any robot can drive; the robot is lost after each");
}

void bindSourceMonitor(py::module_& module) {
  py::class_<SourceMonitor>(module, "SourceMonitor",
                            "Compares markers, other landmarks and places with the pose of all.")
      .def(py::init<>())
      .def("add", &SourceMonitor::add, "applied"_a, "Adds an AppliedScan")
      .def("add_unusable", &SourceMonitor::addUnusable, "stamp"_a,
           "Adds an image with too little content to recognize a place; stamp in seconds")
      .def_property_readonly("supporting", &SourceMonitor::supporting,
                             "sources that support the pose, with their numbers of scans and images")
      .def_property_readonly("problems", &SourceMonitor::problems,
                             "list of sentences, one for each source that contradicts the pose or fails");
}

void bindLandmarkTimeline(py::module_& module) {
  bindLandmarkTimelineParts(module);
  bindSourceMonitor(module);
  bindLandmarkTimelineState(module)
      .def_property_readonly(
          "is_lost", [](const LandmarkTimeline& self) { return self.slam().isLost(); },
          "whether the pose is unknown")
      .def(
          "relocalize",
          [](LandmarkTimeline& self) { self.change([](LandmarkSlam& slam) { slam.relocalize(); }); },
          "Discards the pose: the robot is lost until it is relocalized in its map")
      .def(
          "set_pose",
          [](LandmarkTimeline& self, const Pose2& pose, const Eigen::Matrix3d& covariance) {
            self.change([&](LandmarkSlam& slam) { slam.setPose(pose, covariance); });
          },
          "pose"_a, "covariance"_a, "Replaces the pose (3,) at the newest odometry and its covariance (3, 3)")
      .def(
          "set_map",
          [](LandmarkTimeline& self, const Pose2& pose, const std::vector<Landmark2D>& landmarks,
             const std::vector<LandmarkLabel>& labels, const Eigen::MatrixXd& covariance) {
            self.change([&](LandmarkSlam& slam) { slam.setMap(pose, landmarks, labels, covariance); });
          },
          "pose"_a, "landmarks"_a, "labels"_a, "covariance"_a,
          "Replaces pose and map, as LandmarkSlam.set_map()")
      .def("restart", &LandmarkTimeline::restart, "Drops odometry and scans and keeps the map");
}

void bindLandmarkMapFile(py::module_& module) {
  py::class_<LandmarkMap>(module, "LandmarkMap",
                          "A landmark map with its covariance and the last pose of the robot.")
      .def(py::init([](const std::string& frame, const Pose2& pose, const std::vector<Landmark2D>& landmarks,
                       const std::vector<LandmarkLabel>& labels, const Eigen::MatrixXd& covariance,
                       bool is_lost) {
             LandmarkMap map{frame, pose, landmarks, labels, covariance, is_lost};
             map.validate();
             return map;
           }),
           "frame"_a, "pose"_a, "landmarks"_a, "labels"_a, "covariance"_a, "is_lost"_a = false,
           "Raises ValueError if sizes differ or a value is not valid")
      .def_readonly("frame", &LandmarkMap::frame, "frame_id")
      .def_readonly("pose", &LandmarkMap::T_map_base, "(3,) of the robot")
      .def_readonly("landmarks", &LandmarkMap::landmarks, "list of Landmark2D")
      .def_readonly("labels", &LandmarkMap::labels, "list of LandmarkLabel, one per landmark")
      .def_readonly("covariance", &LandmarkMap::covariance,
                    "(n, n) of x, y, heading of the robot, then x, y[, heading] of each landmark")
      .def_readonly("is_lost", &LandmarkMap::is_lost, "whether the robot was lost: pose is not valid then");
  module.def("read_landmark_map", &readLandmarkMap, "path"_a,
             "LandmarkMap of a YAML file; RuntimeError: file, line and reason");
  module.def("write_landmark_map", &writeLandmarkMap, "landmark_map"_a, "path"_a,
             "Writes a YAML file atomically; RuntimeError: it cannot be written");
}

}  // namespace
}  // namespace sextant

PYBIND11_MODULE(landmarks, module) {
  module.doc() = "Planar SLAM with landmarks.";
  sextant::bindObservations(module);
  sextant::bindOdometrySteps(module);
  sextant::bindLandmarkFilter(module);
  sextant::bindLandmarkSlam(module);
  sextant::bindLandmarkTimeline(module);
  sextant::bindLandmarkMapFile(module);
}
