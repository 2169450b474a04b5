// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/marker_locator.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "marker_innovation.hpp"
#include "sextant/localization/mapped_sighting.hpp"
#include "sextant/localization/pose_posterior.hpp"
#include "sextant/markers/marker_pose.hpp"
#include "sextant/markers/reprojection.hpp"

namespace sextant {
namespace {

// A mapped marker in a view, with the base poses that its two planar solutions give.
struct Seen {
  const MarkerView* view;
  const Detection* detection;
  const MappedMarker* mapped;
  PlanarPoses poses;
  bool trusted;
};

// The trusted ones first.
std::vector<Seen> mappedMarkers(const MarkerMap& map, const std::vector<MarkerView>& views,
                                const std::set<MarkerKey>& distrusted, LocatorResult& result) {
  std::vector<Seen> all, doubtful;
  for (const MarkerView& view : views) {
    for (const Detection& detection : view.detections) {
      const MappedMarker* mapped = map.find(detection.key);
      if (!mapped) {
        result.unmapped.push_back(detection.key);
      } else if (isRepeated(view, detection.key)) {
        result.repeated.push_back(detection.key);
      } else if (const auto poses = solveMarkerPose(view.camera, detection.corners, mapped->size)) {
        const bool trusted = distrusted.count(detection.key) == 0;
        (trusted ? all : doubtful).push_back({&view, &detection, mapped, *poses, trusted});
      }
    }
  }
  all.insert(all.end(), doubtful.begin(), doubtful.end());
  return all;
}

std::vector<Seen> trustedOnes(std::vector<Seen> all) {
  all.erase(std::find_if(all.begin(), all.end(), [](const Seen& seen) { return !seen.trusted; }), all.end());
  return all;
}

std::vector<PoseStart> starts(const std::vector<Seen>& all) {
  std::vector<PoseStart> poses;
  for (size_t i = 0; i < all.size(); ++i) addStarts(*all[i].view, *all[i].mapped, all[i].poses, i, poses);
  return poses;
}

Matrix6d constantCovariance(const std::vector<double>& numbers) {
  return Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(numbers.data());
}

std::optional<FloorPrior> floorPrior(const LocatorParams& params) {
  if (params.floor_height_sigma == 0) return std::nullopt;
  return FloorPrior{params.floor_height_sigma, params.floor_tilt_sigma};
}

LocatedMarker located(const Seen& seen, const MarkerSighting& sighting, const PoseHypothesis& best,
                      bool used) {
  LocatedMarker marker{seen.mapped->key,
                       seen.view->camera_index,
                       used,
                       squaredMahalanobis(sighting, best.T_map_base),
                       seen.view->noise_scale,
                       {}};
  if (!used || best.used.size() > 1)
    marker.innovation = markerInnovation(sighting, seen.poses.best.T_camera_marker, best, used);
  return marker;
}

LocatedPose located(const std::vector<Seen>& all, const std::vector<MarkerSighting>& sightings,
                    const PoseHypothesis& best, const PosePosterior& posterior) {
  LocatedPose pose{best.T_map_base, posterior.covariance, best.rms, posterior.probability, {}};
  for (size_t i = 0; i < all.size(); ++i) {
    const bool used = std::find(best.used.begin(), best.used.end(), i) != best.used.end();
    pose.markers.push_back(located(all[i], sightings[i], best, used));
  }
  return pose;
}

LocatorResult none(const std::string& reason) {
  LocatorResult result;
  result.reason = reason;
  return result;
}

LocatorResult result(const LocatedPose& pose) {
  LocatorResult result;
  result.pose = pose;
  return result;
}

std::vector<MarkerSighting> sightingsOf(const std::vector<Seen>& all, const LocatorParams& params) {
  std::vector<MarkerSighting> sightings;
  for (const Seen& seen : all)
    sightings.push_back(mappedSighting(*seen.view, *seen.detection, *seen.mapped, params.corner_sigma));
  return sightings;
}

// Corners of which it is known where they are: a hidden one's deviation is half a module, of at most twelve a
// side.
int cornersInSight(const Detection& detection) {
  const double hidden = std::max(1.0, shortestSide(detection.corners) / 24);
  return static_cast<int>(std::count_if(detection.corner_sigmas.begin(), detection.corner_sigmas.end(),
                                        [&](double sigma) { return sigma < hidden; }));
}

// Whether there are as many equations as the pose has unknowns.
bool tellPose(const std::vector<Seen>& all, const std::optional<FloorPrior>& floor) {
  int equations = floor ? 3 : 0;
  for (const Seen& seen : all) equations += 2 * cornersInSight(*seen.detection);
  return equations >= 6;
}

LocatorResult joint(const std::vector<Seen>& all, const LocatorParams& params,
                    const std::optional<PosePrior>& prior) {
  const auto trusted = trustedOnes(all);
  const auto sightings = sightingsOf(trusted, params);
  const auto floor = floorPrior(params);
  if (!tellPose(trusted, floor)) return none("fewer than three corners of the markers are in sight");
  const auto hypotheses =
      poseHypotheses(sightings, starts(trusted), {params.robust_width, params.gate, floor}, prior);
  if (hypotheses.empty())
    return none(
        "no pose explains a marker within the gate: do map, marker size, mount, calibration and corner_sigma "
        "fit?");
  const PosePosterior posterior = posePosterior(sightings, hypotheses, {params.decided, floor});
  if (posterior.probability < params.decided && params.ambiguous == "skip")
    return none("ambiguous: more than one pose explains the markers");
  // Those that are not trusted come last: the indices are the same.
  return result(located(all, sightingsOf(all, params), hypotheses[posterior.best], posterior));
}

LocatorResult nearest(const std::vector<Seen>& seen, const LocatorParams& params,
                      const std::optional<PosePrior>& prior) {
  const auto all = trustedOnes(seen);
  const auto floor = floorPrior(params);
  // Those that tell no pose come last.
  const auto order = [&](const Seen& one) {
    return std::make_pair(!tellPose({one}, floor), one.poses.best.T_camera_marker.translation().z());
  };
  return joint({*std::min_element(all.begin(), all.end(),
                                  [&](const Seen& a, const Seen& b) { return order(a) < order(b); })},
               params, prior);
}

LocatorResult average(const std::vector<Seen>& all, const LocatorParams& params,
                      const std::optional<PosePrior>& prior) {
  std::vector<Pose> poses;
  LocatedPose mean{Pose::Identity(), Matrix6d::Zero(), 0.0, 1.0, {}};
  LocatorResult last;
  double squares = 0;
  for (const Seen& seen : trustedOnes(all)) {
    last = joint({seen}, params, prior);
    if (!last.pose) continue;
    poses.push_back(last.pose->T_map_base);
    mean.covariance += last.pose->covariance;
    mean.probability = std::min(mean.probability, last.pose->probability);
    squares += last.pose->reprojection_error * last.pose->reprojection_error;
    mean.markers.push_back(last.pose->markers[0]);
  }
  if (poses.empty()) return last;
  const auto n = static_cast<double>(poses.size());
  mean.T_map_base = meanPose(poses);
  mean.covariance /= n * n;
  mean.reprojection_error = std::sqrt(squares / n);
  return result(mean);
}

using Mode = LocatorResult (*)(const std::vector<Seen>&, const LocatorParams&,
                               const std::optional<PosePrior>&);

const std::map<std::string, Mode>& modes() {
  static const std::map<std::string, Mode> table = {
      {"nearest", nearest}, {"average", average}, {"joint", joint}};
  return table;
}

std::string whyNothing(const std::vector<MarkerView>& views, const LocatorResult& result) {
  const auto empty = [](const MarkerView& view) { return view.detections.empty(); };
  if (std::all_of(views.begin(), views.end(), empty)) return "no marker in sight";
  if (!result.repeated.empty()) return "the only mapped markers in sight are there more than once";
  return result.unmapped.empty() ? "no marker's corners give a pose" : "no marker in sight is in the map";
}

std::vector<MarkerKey> keys(const LocatedPose& pose, bool used) {
  std::vector<MarkerKey> some;
  for (const LocatedMarker& marker : pose.markers)
    if (marker.used == used) some.push_back(marker.key);
  return some;
}

void requireCovariance(const Param& param) {
  const auto& numbers = *std::get<std::vector<double>*>(param.value);
  if (!numbers.empty() && (numbers.size() != 36 || !isCovariance(constantCovariance(numbers))))
    throw std::invalid_argument(
        "constant_covariance must be empty or a symmetric positive matrix of 36 numbers, row by row");
}

}  // namespace

CornerSigmas cornerSigmas(const MarkerView& view, const Detection& detection, double corner_sigma) {
  CornerSigmas sigmas;
  for (int i = 0; i < 4; ++i)
    sigmas[i] = std::hypot(view.noise_scale * corner_sigma, std::max(0.0, detection.corner_sigmas[i]));
  return sigmas;
}

std::vector<MarkerKey> LocatedPose::used() const { return keys(*this, true); }
std::vector<MarkerKey> LocatedPose::leftOut() const { return keys(*this, false); }

ParamList LocatorParams::fields() {
  return {
      {"mode", &mode, oneOf(locatorModes()), "",
       "`nearest`: the marker with the smallest z in the camera frame; `average`: mean of the poses from "
       "every marker; `joint`: one pose from all corners of all markers"},
      {"corner_sigma", &corner_sigma, Range::openLow(0, 10), "px",
       "noise that all corner coordinates have in common; that of the corner itself (`corner_sigmas`) is "
       "added"},
      {"max_reprojection_error", &max_reprojection_error, Range::openLow(0, 1000), "px",
       "RMS over all used corners above which there is no pose"},
      {"robust_width", &robust_width, Range::closed(0.5, 1000), "",
       "in the first search a marker farther off than so many deviations counts less (Huber)"},
      {"gate", &gate, Range::closed(8, 1e6), "",
       "squared Mahalanobis distance of a marker's eight coordinates beyond which the pose leaves it out"},
      {"floor_height_sigma", &floor_height_sigma, Range::closed(0, 10), "m",
       "deviation of the base from the map's plane z = 0; 0: it does not stand on it"},
      {"floor_tilt_sigma", &floor_tilt_sigma, Range::openLow(0, 1), "rad",
       "deviation of the base's roll and pitch from 0; with `floor_height_sigma`"},
      // Hypotheses of a probability of 1e-7 are not looked at: more than 1 - 1e-7 would never be reached.
      {"decided", &decided, Range::closed(0.5, 0.9999999), "",
       "probability from which one of several poses is taken as certain"},
      {"ambiguous", &ambiguous, oneOf({"cover", "skip"}), "",
       "what is published else: the most probable pose with a covariance that holds all of them, or none"},
      {"constant_covariance", &constant_covariance, Allowed("empty or 36", requireCovariance), "",
       "published instead of the measurement's own covariance: row by row, order x y z roll pitch yaw"},
  };
}

MarkerLocator::MarkerLocator(const LocatorParams& params) : params_(params) { validate(params_); }

LocatorResult MarkerLocator::locate(const MarkerMap& map, const std::vector<MarkerView>& views,
                                    const std::optional<PosePrior>& prior,
                                    const std::set<MarkerKey>& distrusted) const {
  LocatorResult result;
  const auto seen = mappedMarkers(map, views, distrusted, result);
  if (seen.empty() || !seen.front().trusted) {
    result.reason = seen.empty() ? whyNothing(views, result)
                                 : "the markers in sight stand elsewhere than the map has them";
    return result;
  }
  const LocatorResult found = modes().at(params_.mode)(seen, params_, prior);
  result.pose = found.pose;
  result.reason = found.reason;
  if (result.pose && !(result.pose->reprojection_error <= params_.max_reprojection_error)) {
    result.reason =
        "reprojection error above max_reprojection_error: do map, marker size and calibration fit?";
    result.pose.reset();
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
