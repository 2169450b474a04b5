// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/marker_localization.hpp"

#include <cmath>

namespace sextant {
namespace {

// Relative change of a noise_scale above which the image is located again.
constexpr double kScaleTolerance = 0.02;
const std::set<MarkerKey> kNoMarkers;

}  // namespace

ParamList LocalizationParams::fields() {
  const ParamList own = {
      {"estimate_noise", &estimate_noise, Allowed(), "",
       "in mode `joint`: estimate the corner noise of each camera, and of single images (e.g. blurred ones), "
       "from the residuals of poses from two or more markers; initial value: `corner_sigma`"},
      {"exclude_moved_markers", &exclude_moved_markers, Allowed(), "",
       "in mode `joint`, with `correct_errors`: ignore markers that were moved from their position in the "
       "map, until they are consistent with it again"},
      {"correct_errors", &correct_errors, Allowed(), "",
       "in mode `joint`: find errors of calibration, rolling shutter, marker size and map in the residuals "
       "of "
       "many images, report them, and correct the following images"},
      {"readout_time", &readout_time, Range::closed(0, 0.2), "s",
       "time between the first and the last row of the cameras (rolling shutter), if it is known; 0: all "
       "rows "
       "at once. With `correct_errors`, its error is estimated"},
  };
  return joined({locator.fields(), own, prefixed("odometry_", odometry.fields())});
}

MarkerLocalization::MarkerLocalization(const LocalizationParams& params)
    : params_(params), locator_(params.locator), correction_(params.odometry), errors_(params.readout_time) {}

void MarkerLocalization::setParams(const LocalizationParams& params) {
  validate(params);
  locator_ = MarkerLocator(params.locator);
  correction_.setParams(params.odometry);
  if (params.readout_time != params_.readout_time || !params.correct_errors)
    errors_ = ErrorCorrection(params.readout_time);
  params_ = params;
}

LocatorResult MarkerLocalization::locate(const MarkerMap& file, const std::vector<MarkerView>& views,
                                         const std::optional<Pose>& T_odom_base,
                                         const std::optional<double>& stamp) {
  if (correctsErrors()) replay(file);
  auto motion = errors_.motion(stamp, std::nullopt);
  auto corrected = errors_.corrected(file, views, motion);
  const MarkerMap map = errors_.corrected(file, views);
  LocatorResult result = locateWithOdometry(map, corrected, T_odom_base);
  if (result.pose && errors_.needsMotion()) {
    motion = errors_.motion(stamp, result.pose->T_map_base);
    corrected = errors_.corrected(file, views, motion);
    result = locateWithOdometry(map, corrected, T_odom_base);
  }
  if (result.pose && T_odom_base) result = gatedByOdometry(result, *T_odom_base);
  if (correctsErrors()) findErrors(file, {views, corrected, map, stamp, motion}, result);
  if (result.pose && estimatesNoise()) noise_.add(*result.pose);
  return result;
}

void MarkerLocalization::findErrors(const MarkerMap& file, const ErrorCorrection::Images& images,
                                    LocatorResult& result) {
  auto& pose = result.pose ? result.pose : result.rejected;
  if (!pose) return;
  errors_.add(file, images, params_.locator.corner_sigma, moved_markers_.keys(), *pose);
  if (moved_markers_.add(*pose, images.corrected_map)) errors_.evaluate();
  for (const MarkerKey& key : errors_.takeMoved()) moved_markers_.exclude(key);
}

void MarkerLocalization::replay(const MarkerMap& file) {
  const auto locate = [this](const MarkerMap& map, std::vector<MarkerView>& views) {
    return locateWithNoise(map, views, std::nullopt);
  };
  errors_.replay(file, params_.locator.corner_sigma, moved_markers_.keys(), locate);
}

// If the prior contradicts every pose that the markers allow, it may be wrong itself: locates without it.
LocatorResult MarkerLocalization::locateWithOdometry(const MarkerMap& map, std::vector<MarkerView>& views,
                                                     const std::optional<Pose>& T_odom_base) {
  const auto prior = T_odom_base ? correction_.predict(*T_odom_base) : std::nullopt;
  LocatorResult result = locateWithNoise(map, views, prior);
  if (prior && result.pose &&
      correction_.contradicts(*T_odom_base, result.pose->T_map_base, result.pose->covariance))
    result = locateWithNoise(map, views, std::nullopt);
  return result;
}

bool MarkerLocalization::correctsErrors() const {
  return params_.correct_errors && params_.locator.mode == "joint";
}

bool MarkerLocalization::estimatesNoise() const {
  return params_.estimate_noise && params_.locator.mode == "joint";
}

// Locates with the noise of each camera, then again with the noise of each image, if that differs.
LocatorResult MarkerLocalization::locateWithNoise(const MarkerMap& map, std::vector<MarkerView>& views,
                                                  const std::optional<PosePrior>& prior) {
  const auto& ignored = params_.exclude_moved_markers ? moved_markers_.keys() : kNoMarkers;
  if (estimatesNoise())
    for (MarkerView& view : views) view.noise_scale = noise_.scale(view.camera_index);
  LocatorResult result = locator_.locate(map, views, prior, ignored);
  if (!estimatesNoise() || !result.pose) return result;
  const auto image_noise = imageNoise(*result.pose);
  bool differs = false;
  for (MarkerView& view : views) {
    if (view.camera_index >= image_noise.size()) continue;
    const double scale = noise_.scale(view.camera_index, image_noise[view.camera_index]);
    differs |= std::abs(scale / view.noise_scale - 1) > kScaleTolerance;
    view.noise_scale = scale;
  }
  return differs ? locator_.locate(map, views, prior, ignored) : result;
}

// Corrects T_map_odom with the pose, or drops the pose if it contradicts odometry. An ambiguous pose is only
// used to initialize T_map_odom.
LocatorResult MarkerLocalization::gatedByOdometry(LocatorResult result, const Pose& T_odom_base) {
  const LocatedPose& pose = *result.pose;
  const bool unambiguous = pose.probability >= params_.locator.min_probability;
  if (!unambiguous && correction_.transform()) return result;
  if (correction_.update(T_odom_base, pose.T_map_base, pose.covariance) !=
      OdometryCorrection::Verdict::rejected)
    return result;
  result.pose.reset();
  result.reason = "the markers contradict the odometry";
  return result;
}

void MarkerLocalization::resetMap() {
  correction_.reset();
  moved_markers_.reset();
  errors_.reset();
}

void MarkerLocalization::reset() {
  resetMap();
  noise_.reset();
}

}  // namespace sextant
