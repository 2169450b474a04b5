// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/marker_localization.hpp"

#include <cmath>

namespace sextant {
namespace {

constexpr double kSameScale = 0.02;
const std::set<MarkerKey> kNone;

}  // namespace

ParamList LocalizationParams::fields() {
  const ParamList own = {
      {"estimate_noise", &estimate_noise, Allowed(), "",
       "`corner_sigma` is where it begins; then it is estimated by the residuals of poses from two markers "
       "or more, camera by camera, and image by image where these differ (some are blurred)"},
      {"leave_out_moved", &leave_out_moved, Allowed(), "",
       "markers that are found to stand elsewhere than in the map do not count, until they agree again"},
  };
  return joined({locator.fields(), own, prefixed("odometry_", odometry.fields())});
}

MarkerLocalization::MarkerLocalization(const LocalizationParams& params)
    : params_(params), locator_(params.locator), correction_(params.odometry) {}

void MarkerLocalization::setParams(const LocalizationParams& params) {
  validate(params);
  locator_ = MarkerLocator(params.locator);
  correction_.setParams(params.odometry);
  params_ = params;
}

LocatorResult MarkerLocalization::locate(const MarkerMap& map, std::vector<MarkerView> views,
                                         const std::optional<Pose>& T_odom_base) {
  const auto prior = T_odom_base ? correction_.predict(*T_odom_base) : std::nullopt;
  LocatorResult result = locateWithNoise(map, views, prior);
  // Where the prior fits none of the poses that the markers leave it is not asked: it may be wrong itself.
  if (prior && result.pose &&
      correction_.contradicts(*T_odom_base, result.pose->T_map_base, result.pose->covariance))
    result = locateWithNoise(map, views, std::nullopt);
  if (result.pose && T_odom_base) result = judged(result, *T_odom_base);
  if (!result.pose) return result;
  watch_.add(*result.pose, map);
  if (estimatesNoise()) noise_.add(*result.pose);
  return result;
}

bool MarkerLocalization::estimatesNoise() const {
  return params_.estimate_noise && params_.locator.mode == "joint";
}

// First with what is known of the camera's noise, then with what the image itself says of it.
LocatorResult MarkerLocalization::locateWithNoise(const MarkerMap& map, std::vector<MarkerView>& views,
                                                  const std::optional<PosePrior>& prior) {
  const auto& distrusted = params_.leave_out_moved ? watch_.distrusted() : kNone;
  if (estimatesNoise())
    for (MarkerView& view : views) view.noise_scale = noise_.scale(view.camera_index);
  LocatorResult result = locator_.locate(map, views, prior, distrusted);
  if (!estimatesNoise() || !result.pose) return result;
  const auto images = imageNoise(*result.pose);
  bool differs = false;
  for (MarkerView& view : views) {
    if (view.camera_index >= images.size()) continue;
    const double scale = noise_.scale(view.camera_index, images[view.camera_index]);
    differs |= std::abs(scale / view.noise_scale - 1) > kSameScale;
    view.noise_scale = scale;
  }
  return differs ? locator_.locate(map, views, prior, distrusted) : result;
}

// An undecided pose neither corrects nor refutes, but it is better than none to begin with.
LocatorResult MarkerLocalization::judged(LocatorResult result, const Pose& T_odom_base) {
  const LocatedPose& pose = *result.pose;
  const bool certain = pose.probability >= params_.locator.decided;
  if (!certain && correction_.transform()) return result;
  if (correction_.update(T_odom_base, pose.T_map_base, pose.covariance) !=
      OdometryCorrection::Verdict::contradicts)
    return result;
  result.pose.reset();
  result.reason = "the markers contradict the odometry";
  return result;
}

void MarkerLocalization::forgetMap() {
  correction_.reset();
  watch_.reset();
}

void MarkerLocalization::reset() {
  forgetMap();
  noise_.reset();
}

}  // namespace sextant
