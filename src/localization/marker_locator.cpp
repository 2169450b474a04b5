// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/marker_locator.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "sextant/localization/mapped_observation.hpp"
#include "sextant/localization/marker_innovation.hpp"
#include "sextant/localization/pose_posterior.hpp"
#include "sextant/markers/marker_pose.hpp"
#include "sextant/markers/reprojection.hpp"

namespace sextant {
namespace {

constexpr double kMapSigmas = 3.0;  // standard deviations of the map that a reprojection error may have

// A detection of a mapped marker, with its two planar solutions.
struct MappedDetection {
  const MarkerView* view;
  const Detection* detection;
  const MappedMarker* mapped;
  PlanarPoses poses;
  bool trusted;  // false: to be ignored, because the marker was moved
};

// Returns the detections of mapped markers, the trusted ones first. Lists unmapped and repeated ones in
// the result.
std::vector<MappedDetection> mappedDetections(const MarkerMap& map, const std::vector<MarkerView>& views,
                                              const std::set<MarkerKey>& ignored, LocatorResult& result) {
  std::vector<MappedDetection> markers, ignored_markers;
  for (const MarkerView& view : views) {
    for (const Detection& detection : view.detections) {
      const MappedMarker* mapped = map.find(detection.key);
      if (!mapped) {
        result.unmapped.push_back(detection.key);
      } else if (isRepeated(view, detection.key)) {
        result.repeated.push_back(detection.key);
      } else if (const auto poses = solveMarkerPose(view.camera, detection.corners, mapped->size)) {
        const bool trusted = ignored.count(detection.key) == 0;
        (trusted ? markers : ignored_markers).push_back({&view, &detection, mapped, *poses, trusted});
      }
    }
  }
  markers.insert(markers.end(), ignored_markers.begin(), ignored_markers.end());
  return markers;
}

std::vector<MappedDetection> trustedMarkers(std::vector<MappedDetection> markers) {
  const auto ignored = [](const MappedDetection& marker) { return !marker.trusted; };
  markers.erase(std::find_if(markers.begin(), markers.end(), ignored), markers.end());
  return markers;
}

std::vector<InitialPose> initialPosesOf(const std::vector<MappedDetection>& markers) {
  std::vector<InitialPose> initial_poses;
  for (size_t i = 0; i < markers.size(); ++i)
    addInitialPoses(*markers[i].view, *markers[i].mapped, markers[i].poses, i, initial_poses);
  return initial_poses;
}

Matrix6d constantCovariance(const std::vector<double>& numbers) {
  return Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(numbers.data());
}

std::optional<FloorPrior> floorPrior(const LocatorParams& params) {
  if (params.floor_height_sigma == 0) return std::nullopt;
  return FloorPrior{params.floor_height_sigma, params.floor_tilt_sigma};
}

// Squared Mahalanobis distance of the corners from their projection at the pose of the base that fits this
// marker best, near one of its planar solutions.
double ownSquares(const MappedDetection& detected, MarkerObservation observation) {
  observation.map_covariance.setZero();
  const Pose T_map_base =
      observation.T_map_marker * detected.poses.best.T_camera_marker.inverse() * observation.T_camera_base;
  const ReprojectionModel model = reprojectionModel({observation}, T_map_base, {});
  return std::max(0.0, model.cost - model.g.dot(model.H.ldlt().solve(model.g)));
}

LocatedMarker locatedMarker(const MappedDetection& detected, const MarkerObservation& observation,
                            const PoseHypothesis& best, bool used) {
  LocatedMarker marker{detected.mapped->key,
                       detected.view->camera_index,
                       used,
                       squaredMahalanobis(observation, best.T_map_base),
                       ownSquares(detected, observation),
                       detected.view->noise_scale,
                       {}};
  if (!used || best.used.size() > 1)
    marker.innovation = markerInnovation(observation, detected.poses.best.T_camera_marker, best, used);
  return marker;
}

// RMS over the used corners' coordinates of what the map's covariance moves them by, pixels.
double mapDeviation(const std::vector<MarkerObservation>& observations, const PoseHypothesis& best) {
  double variance = 0;
  for (const size_t i : best.used) {
    if (observations[i].map_covariance.isZero(0.0)) continue;
    const auto linear = linearizedMarker(observations[i], best.T_map_base);
    if (!linear) continue;
    variance += linear->covariance.trace() / 8;
    for (const double sigma : observations[i].sigmas) variance -= sigma * sigma / 4;
  }
  return std::sqrt(std::max(0.0, variance) / static_cast<double>(std::max<size_t>(best.used.size(), 1)));
}

LocatedPose locatedPose(const std::vector<MappedDetection>& markers,
                        const std::vector<MarkerObservation>& observations, const PoseHypothesis& best,
                        const PosePosterior& posterior) {
  LocatedPose pose{best.T_map_base,
                   posterior.covariance,
                   best.rms,
                   mapDeviation(observations, best),
                   posterior.probability,
                   {}};
  for (size_t i = 0; i < markers.size(); ++i) {
    const bool used = std::find(best.used.begin(), best.used.end(), i) != best.used.end();
    pose.markers.push_back(locatedMarker(markers[i], observations[i], best, used));
  }
  return pose;
}

LocatorResult noPose(const std::string& reason) {
  LocatorResult result;
  result.reason = reason;
  return result;
}

LocatorResult withPose(const LocatedPose& pose) {
  LocatorResult result;
  result.pose = pose;
  return result;
}

std::vector<MarkerObservation> observationsOf(const std::vector<MappedDetection>& markers,
                                              const LocatorParams& params) {
  std::vector<MarkerObservation> observations;
  for (const MappedDetection& marker : markers)
    observations.push_back(
        mappedObservation(*marker.view, *marker.detection, *marker.mapped, params.corner_sigma));
  return observations;
}

// Number of corners that are not occluded. An occluded corner has a corner_sigma of at least half a module,
// and a side has at most twelve modules: at least 1/24 of the side.
int cornersInSight(const Detection& detection) {
  const double occluded_sigma = std::max(1.0, shortestSide(detection.corners) / 24);
  return static_cast<int>(std::count_if(detection.corner_sigmas.begin(), detection.corner_sigmas.end(),
                                        [&](double sigma) { return sigma < occluded_sigma; }));
}

// Whether the visible corners (and the floor) give at least as many equations as the pose has unknowns.
bool determinePose(const std::vector<MappedDetection>& markers, const std::optional<FloorPrior>& floor) {
  int equations = floor ? 3 : 0;
  for (const MappedDetection& marker : markers) equations += 2 * cornersInSight(*marker.detection);
  return equations >= 6;
}

LocatorResult joint(const std::vector<MappedDetection>& markers, const LocatorParams& params,
                    const std::optional<PosePrior>& prior) {
  const auto trusted = trustedMarkers(markers);
  const auto observations = observationsOf(trusted, params);
  const auto floor = floorPrior(params);
  if (!determinePose(trusted, floor)) return noPose("fewer than three corners of the markers are in sight");
  const auto hypotheses =
      poseHypotheses(observations, initialPosesOf(trusted), {params.robust_width, params.gate, floor}, prior);
  if (hypotheses.empty())
    return noPose(
        "no pose fits any marker: do map, marker size, mount, calibration and corner_sigma "
        "fit?");
  const PosePosterior posterior = posePosterior(observations, hypotheses, {params.min_probability, floor});
  if (posterior.probability < params.min_probability && params.ambiguous_pose == "skip")
    return noPose("ambiguous: more than one pose explains the markers");
  // Ignored markers are last, so the indices of the trusted ones are the same in both lists.
  return withPose(
      locatedPose(markers, observationsOf(markers, params), hypotheses[posterior.best], posterior));
}

LocatorResult nearest(const std::vector<MappedDetection>& markers, const LocatorParams& params,
                      const std::optional<PosePrior>& prior) {
  const auto trusted = trustedMarkers(markers);
  const auto floor = floorPrior(params);
  // Markers whose visible corners do not determine a pose come last.
  const auto rank = [&](const MappedDetection& marker) {
    return std::make_pair(!determinePose({marker}, floor),
                          marker.poses.best.T_camera_marker.translation().z());
  };
  return joint({*std::min_element(
                   trusted.begin(), trusted.end(),
                   [&](const MappedDetection& a, const MappedDetection& b) { return rank(a) < rank(b); })},
               params, prior);
}

LocatorResult average(const std::vector<MappedDetection>& markers, const LocatorParams& params,
                      const std::optional<PosePrior>& prior) {
  std::vector<Pose> poses;
  LocatedPose mean{Pose::Identity(), Matrix6d::Zero(), 0.0, 0.0, 1.0, {}};
  LocatorResult last;
  double squared_errors = 0, map_variance = 0;
  for (const MappedDetection& marker : trustedMarkers(markers)) {
    last = joint({marker}, params, prior);
    if (!last.pose) continue;
    poses.push_back(last.pose->T_map_base);
    mean.covariance += last.pose->covariance;
    mean.probability = std::min(mean.probability, last.pose->probability);
    squared_errors += last.pose->reprojection_error * last.pose->reprojection_error;
    map_variance += last.pose->map_deviation * last.pose->map_deviation;
    mean.markers.push_back(last.pose->markers[0]);
  }
  if (poses.empty()) return last;
  const auto n = static_cast<double>(poses.size());
  mean.T_map_base = meanPose(poses);
  mean.covariance /= n * n;
  mean.reprojection_error = std::sqrt(squared_errors / n);
  mean.map_deviation = std::sqrt(map_variance / n);
  return withPose(mean);
}

using Mode = LocatorResult (*)(const std::vector<MappedDetection>&, const LocatorParams&,
                               const std::optional<PosePrior>&);

const std::map<std::string, Mode>& modes() {
  static const std::map<std::string, Mode> table = {
      {"nearest", nearest}, {"average", average}, {"joint", joint}};
  return table;
}

// Why no detection can be used.
std::string reasonForNoMarkers(const std::vector<MarkerView>& views, const LocatorResult& result) {
  const auto empty = [](const MarkerView& view) { return view.detections.empty(); };
  if (std::all_of(views.begin(), views.end(), empty)) return "no marker in sight";
  if (!result.repeated.empty())
    return "the mapped markers in sight were detected more than once, or their corners give no pose";
  return result.unmapped.empty() ? "no marker's corners give a pose" : "no marker in sight is in the map";
}

std::vector<MarkerKey> keysOf(const LocatedPose& pose, bool used) {
  std::vector<MarkerKey> keys;
  for (const LocatedMarker& marker : pose.markers)
    if (marker.used == used) keys.push_back(marker.key);
  return keys;
}

void requireCovariance(const Param& param) {
  const auto& numbers = *std::get<std::vector<double>*>(param.value);
  if (!numbers.empty() && (numbers.size() != 36 || !isCovariance(constantCovariance(numbers))))
    throw std::invalid_argument(
        "constant_covariance must be empty or 36 numbers: a symmetric positive semidefinite matrix, row by "
        "row");
}

}  // namespace

CornerSigmas cornerSigmas(const MarkerView& view, const Detection& detection, double corner_sigma) {
  CornerSigmas sigmas;
  for (int i = 0; i < 4; ++i)
    sigmas[i] = std::hypot(view.noise_scale * corner_sigma, std::max(0.0, detection.corner_sigmas[i]));
  return sigmas;
}

std::vector<MarkerKey> LocatedPose::used() const { return keysOf(*this, true); }
std::vector<MarkerKey> LocatedPose::outliers() const { return keysOf(*this, false); }

ParamList LocatorParams::fields() {
  return {
      {"mode", &mode, oneOf(locatorModes()), "",
       "`nearest`: pose from the marker with the smallest z in the camera frame; `average`: mean of the "
       "poses from each marker; `joint`: one pose from all corners of all markers"},
      {"corner_sigma", &corner_sigma, Range::openLow(0, 10), "px",
       "standard deviation of corner coordinates, common to all corners; each corner's own (`corner_sigmas` "
       "of sextant/Marker) is added in quadrature"},
      {"max_reprojection_error", &max_reprojection_error, Range::openLow(0, 1000), "px",
       "maximum reprojection error (RMS over all used corners) of a pose; larger by three standard "
       "deviations of the map, if it has a covariance"},
      {"robust_width", &robust_width, Range::closed(0.5, 1000), "",
       "threshold of a marker's Huber loss, standard deviations, in the minimization over all markers; the "
       "next one is without Huber loss, over the markers within `gate`"},
      {"gate", &gate, Range::closed(8, 1e6), "",
       "squared Mahalanobis distance of a marker's eight coordinates beyond which it is an outlier"},
      {"floor_height_sigma", &floor_height_sigma, Range::closed(0, 10), "m",
       "standard deviation of the base's height above the plane z = 0 of the map; 0: no floor"},
      {"floor_tilt_sigma", &floor_tilt_sigma, Range::openLow(0, 1), "rad",
       "standard deviation of the base's roll and pitch, if `floor_height_sigma` is set"},
      // Hypotheses with a probability below 1e-7 are dropped, so a minimum above 1 - 1e-7 is pointless.
      {"min_probability", &min_probability, Range::closed(0.5, 0.9999999), "",
       "minimum probability of a pose to be considered unambiguous"},
      {"ambiguous_pose", &ambiguous_pose, oneOf({"inflate", "skip"}), "",
       "if no pose reaches `min_probability`: `inflate`: publish the most probable one with a covariance "
       "that includes the others; `skip`: publish none"},
      {"constant_covariance", &constant_covariance, Allowed("empty or 36", requireCovariance), "",
       "published instead of the computed covariance: row by row, order x y z roll pitch yaw"},
  };
}

MarkerLocator::MarkerLocator(const LocatorParams& params) : params_(params) { validate(params_); }

LocatorResult MarkerLocator::locate(const MarkerMap& map, const std::vector<MarkerView>& views,
                                    const std::optional<PosePrior>& prior,
                                    const std::set<MarkerKey>& ignored) const {
  LocatorResult result;
  const auto markers = mappedDetections(map, views, ignored, result);
  if (markers.empty() || !markers.front().trusted) {
    result.reason = markers.empty() ? reasonForNoMarkers(views, result)
                                    : "all markers in sight were moved from their positions in the map";
    return result;
  }
  const LocatorResult located = modes().at(params_.mode)(markers, params_, prior);
  result.pose = located.pose;
  result.reason = located.reason;
  if (result.pose && !(result.pose->reprojection_error <=
                       std::hypot(params_.max_reprojection_error, kMapSigmas * result.pose->map_deviation))) {
    result.reason =
        "reprojection error above max_reprojection_error: check map, marker sizes and calibration";
    result.rejected.swap(result.pose);
  }
  if (result.pose && !params_.constant_covariance.empty())
    result.pose->covariance = constantCovariance(params_.constant_covariance);
  return result;
}

std::vector<std::string> locatorModes() {
  std::vector<std::string> names;
  for (const auto& entry : modes()) names.push_back(entry.first);
  return names;
}

}  // namespace sextant
