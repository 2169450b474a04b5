// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/core/marker_localization.hpp"

namespace sextant {

void LocalizationParams::validate() const {
  locator.validate();
  odometry.validate();
}

MarkerLocalization::MarkerLocalization(const LocalizationParams& params)
    : params_(params), locator_(params.locator), correction_(params.odometry) {}

void MarkerLocalization::setParams(const LocalizationParams& params) {
  params.validate();
  locator_ = MarkerLocator(params.locator);
  correction_.setParams(params.odometry);
  params_ = params;
}

LocatorResult MarkerLocalization::locate(const MarkerMap& map, std::vector<MarkerView> views,
                                         const std::optional<Pose>& T_odom_base) {
  if (params_.estimate_noise)
    for (MarkerView& view : views) view.noise_scale = noise_.scale(view.camera_index);
  const LocatorResult result =
      T_odom_base ? reconciled(map, views, *T_odom_base) : locator_.locate(map, views);
  if (!result.pose) return result;
  watch_.add(*result.pose, map);
  if (params_.locator.mode == "joint") noise_.add(*result.pose);
  return result;
}

// The prior decides between the poses that the markers leave. Where it fits none of them it is not asked: it
// may be wrong itself.
LocatorResult MarkerLocalization::reconciled(const MarkerMap& map, const std::vector<MarkerView>& views,
                                             const Pose& T_odom_base) {
  const auto prior = correction_.predict(T_odom_base);
  LocatorResult result = locator_.locate(map, views, prior);
  const auto astray = [&] {
    return result.pose &&
           correction_.contradicts(T_odom_base, result.pose->T_map_base, result.pose->covariance);
  };
  if (prior && astray()) result = locator_.locate(map, views);
  return result.pose ? judged(result, T_odom_base) : result;
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
