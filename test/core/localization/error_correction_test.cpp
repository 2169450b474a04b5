// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/localization/error_correction.hpp"

#include <gtest/gtest.h>

#include "sextant/localization/marker_localization.hpp"
#include "test_cameras.hpp"
#include "test_room.hpp"

namespace sextant {
namespace {

constexpr double kReadout = 0.03, kPeriod = 0.1;  // seconds

// A robot that turns at 0.5 rad/s and drives sideways at 0.4 m/s.
Pose turningAt(double time) { return kTruth * poseFromXyzRpy({0, 0.4 * time, 0}, {0, 0, 0.5 * time}); }

// The corners at the times of their rows; the stamp is that of the middle row.
MarkerView rolling(const CameraModel& camera, double stamp) {
  MarkerView view = look(room(), camera, turningAt(stamp), 0, 1);
  for (int round = 0; round < 3; ++round)
    for (Detection& detection : view.detections)
      for (int k = 0; k < 4; ++k) {
        const double time = stamp + kReadout * rowTime(camera, detection.corners[k].y());
        for (const Detection& other : look(room(), camera, turningAt(time), 0, 1).detections)
          if (other.key == detection.key) detection.corners[k] = other.corners[k];
      }
  return view;
}

double lastError(double readout_time) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  LocalizationParams params;
  params.readout_time = readout_time;
  MarkerLocalization localization{params};
  double error = 0;
  for (int i = 0; i < 6; ++i) {
    const double stamp = kPeriod * (i - 3);
    const auto result = localization.locate(room(), {rolling(camera, stamp)}, std::nullopt, stamp);
    EXPECT_TRUE(result.pose) << result.reason;
    if (result.pose) error = poseError(turningAt(stamp), result.pose->T_map_base).head<3>().norm();
  }
  return error;
}

TEST(ErrorCorrection, AKnownReadoutTimeIsUsed) {
  const double without = lastError(0), with = lastError(kReadout);
  EXPECT_GT(without, 0.003);
  EXPECT_LT(with, 0.1 * without);
}

TEST(ErrorCorrection, WithoutErrorsNothingIsChanged) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  const ErrorCorrection correction(0);
  const MarkerView view = look(room(), camera, kTruth, 0, 1);
  const auto corrected = correction.corrected(room(), {view}, std::nullopt);
  EXPECT_EQ(corrected[0].detections[0].corners[2], view.detections[0].corners[2]);
  EXPECT_FALSE(correction.needsMotion());
  EXPECT_EQ(correction.corrected(room(), {view}).find({kFamily, 1})->size, 0.2);
}

}  // namespace
}  // namespace sextant
