// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/core/marker_locator.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <stdexcept>

#include "sextant/core/marker_pose.hpp"
#include "sextant/core/range.hpp"
#include "sextant/core/reprojection.hpp"

namespace sextant {
namespace {

constexpr size_t kRefined = 3;  // joint: the best so many candidates are refined

// A mapped marker in a view, with the base poses that its two planar solutions give.
struct Seen {
  const MarkerView* view;
  const Detection* detection;
  const MappedMarker* mapped;
  PlanarPoses poses;
};

Pose basePose(const Seen& seen, const MarkerPose& solution) {
  return seen.mapped->T_map_marker * solution.T_camera_marker.inverse() * seen.view->T_base_camera.inverse();
}

std::vector<Sighting> sightings(const std::vector<Seen>& all) {
  std::vector<Sighting> corners;
  for (const Seen& seen : all) {
    const auto points = markerCorners(seen.mapped->size);
    for (int k = 0; k < 4; ++k)
      corners.push_back({&seen.view->camera, seen.view->T_base_camera.inverse(),
                         seen.mapped->T_map_marker * points[k], seen.detection->corners[k]});
  }
  return corners;
}

// Symmetric to the last bit.
Matrix6d inverseOf(const Matrix6d& information) {
  const Matrix6d inverse = information.ldlt().solve(Matrix6d::Identity());
  return 0.5 * (inverse + inverse.transpose());
}

bool repeated(const MarkerView& view, const MarkerKey& key) {
  return std::count_if(view.detections.begin(), view.detections.end(),
                       [&](const Detection& other) { return other.key == key; }) > 1;
}

std::vector<Seen> mappedMarkers(const MarkerMap& map, const std::vector<MarkerView>& views,
                                LocatorResult& result) {
  std::vector<Seen> all;
  for (const MarkerView& view : views) {
    for (const Detection& detection : view.detections) {
      const MappedMarker* mapped = map.find(detection.key);
      if (!mapped) {
        result.unmapped.push_back(detection.key);
      } else if (repeated(view, detection.key)) {
        result.repeated.push_back(detection.key);
      } else if (const auto poses = solveMarkerPose(view.camera, detection.corners, mapped->size)) {
        all.push_back({&view, &detection, mapped, *poses});
      }
    }
  }
  return all;
}

std::optional<LocatedPose> single(const Seen& seen, const LocatorParams& params) {
  const auto fit =
      minimizeReprojection(sightings({seen}), basePose(seen, seen.poses.best), {params.corner_sigma, 1e9});
  if (!fit) return std::nullopt;
  return LocatedPose{fit->T_map_base, inverseOf(fit->information), fit->rms, {seen.mapped->key}};
}

std::optional<LocatedPose> nearest(const std::vector<Seen>& all, const LocatorParams& params) {
  const auto depth = [](const Seen& seen) { return seen.poses.best.T_camera_marker.translation().z(); };
  return single(*std::min_element(all.begin(), all.end(),
                                  [&](const Seen& a, const Seen& b) { return depth(a) < depth(b); }),
                params);
}

std::optional<LocatedPose> average(const std::vector<Seen>& all, const LocatorParams& params) {
  std::vector<Pose> poses;
  LocatedPose mean{Pose::Identity(), Matrix6d::Zero(), 0.0, {}};
  double squares = 0;
  for (const Seen& seen : all) {
    const auto located = single(seen, params);
    if (!located) continue;
    poses.push_back(located->T_map_base);
    mean.covariance += located->covariance;
    squares += located->reprojection_error * located->reprojection_error;
    mean.used.push_back(seen.mapped->key);
  }
  if (poses.empty()) return std::nullopt;
  const auto n = static_cast<double>(poses.size());
  mean.T_map_base = meanPose(poses);
  mean.covariance /= n * n;
  mean.reprojection_error = std::sqrt(squares / n);
  return mean;
}

// Every single-marker candidate, the best ones by the robust cost of all corners first.
std::vector<Pose> candidates(const std::vector<Seen>& all, const std::vector<Sighting>& corners,
                             const ReprojectionParams& params) {
  std::vector<std::pair<double, Pose>> scored;
  const auto score = [&](const Pose& pose) {
    scored.emplace_back(reprojectionCost(corners, pose, params), pose);
  };
  for (const Seen& seen : all) {
    score(basePose(seen, seen.poses.best));
    if (seen.poses.alternative) score(basePose(seen, *seen.poses.alternative));
  }
  std::sort(scored.begin(), scored.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  if (scored.size() > kRefined) scored.resize(kRefined);
  std::vector<Pose> poses;
  for (const auto& entry : scored) poses.push_back(entry.second);
  return poses;
}

std::optional<LocatedPose> joint(const std::vector<Seen>& all, const LocatorParams& params) {
  const ReprojectionParams robust{params.corner_sigma, params.robust_width};
  const auto corners = sightings(all);
  std::optional<ReprojectionFit> best;
  for (const Pose& start : candidates(all, corners, robust)) {
    const auto fit = minimizeReprojection(corners, start, robust);
    if (fit && (!best || fit->cost < best->cost)) best = fit;
  }
  if (!best) return std::nullopt;
  LocatedPose pose{best->T_map_base, inverseOf(best->information), best->rms, {}};
  for (const Seen& seen : all) pose.used.push_back(seen.mapped->key);
  return pose;
}

using Mode = std::optional<LocatedPose> (*)(const std::vector<Seen>&, const LocatorParams&);

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

}  // namespace

void LocatorParams::validate() const {
  if (modes().count(mode) == 0)
    throw std::invalid_argument("mode is '" + mode + "', allowed are nearest, average and joint");
  Range::openLow(0, 10).require("corner_sigma", corner_sigma, "px");
  Range::openLow(0, 1000).require("max_reprojection_error", max_reprojection_error, "px");
  Range::closed(0.5, 1000).require("robust_width", robust_width);
}

MarkerLocator::MarkerLocator(const LocatorParams& params) : params_(params) { params_.validate(); }

LocatorResult MarkerLocator::locate(const MarkerMap& map, const std::vector<MarkerView>& views) const {
  LocatorResult result;
  const auto seen = mappedMarkers(map, views, result);
  if (seen.empty()) {
    result.reason = whyNothing(views, result);
    return result;
  }
  result.pose = modes().at(params_.mode)(seen, params_);
  if (!result.pose) {
    result.reason = "the corners leave the pose undetermined";
  } else if (!(result.pose->reprojection_error <= params_.max_reprojection_error)) {
    result.reason =
        "reprojection error above max_reprojection_error: do map, marker size and calibration fit?";
    result.pose.reset();
  }
  return result;
}

std::vector<std::string> locatorModes() {
  std::vector<std::string> names;
  for (const auto& entry : modes()) names.push_back(entry.first);
  return names;
}

}  // namespace sextant
