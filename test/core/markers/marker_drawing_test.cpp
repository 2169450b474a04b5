// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/marker_drawing.hpp"

#include <gtest/gtest.h>

#include "test_cameras.hpp"

namespace sextant {
namespace {

std::vector<ObservedMarker> oneMarker(const CameraModel& camera) {
  const Pose truth = poseFromXyzRpy({0, 0, 1.0}, {M_PI + 0.5, 0.2, 0});
  Detection detection;
  detection.key = {"tag36h11", 7};
  for (int i = 0; i < 4; ++i) detection.corners[i] = *camera.project(truth * markerCorners(0.4)[i]);
  return observeMarkers(camera, {detection}, {0.4, {}}, 0.3);
}

TEST(MarkerPicture, DrawsOutlineAndAxesWhereTheyAre) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  const auto markers = oneMarker(camera);
  const cv::Mat grey(480, 640, CV_8UC1, cv::Scalar(100));
  const cv::Mat picture = drawMarkers(grey, camera, markers, 0);
  ASSERT_EQ(picture.size(), grey.size());
  ASSERT_EQ(picture.type(), CV_8UC3);
  const auto at = [&](const Eigen::Vector2d& p) {
    return picture.at<cv::Vec3b>(std::lround(p.y()), std::lround(p.x()));
  };
  const auto& corners = markers[0].detection.corners;
  EXPECT_GT(at(0.5 * (corners[0] + corners[1]))[2], 200);  // yellow
  const Pose& T = markers[0].poses->best.T_camera_marker;
  const cv::Vec3b x_axis = at(*camera.project(T * Eigen::Vector3d(0.12, 0, 0)));
  EXPECT_GT(x_axis[2], x_axis[1] + 50);  // red
  EXPECT_EQ(at({5, 5}), cv::Vec3b(100, 100, 100));
}

TEST(MarkerPicture, ResidualsAreFiftyTimesAsLong) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  auto markers = oneMarker(camera);
  const Eigen::Vector2d corner = markers[0].detection.corners[2];
  markers[0].detection.corners[2] +=
      Eigen::Vector2d(-0.6, 0);  // the pose stays: its corner lies to the right
  const cv::Mat grey(480, 640, CV_8UC1, cv::Scalar(100));
  const cv::Mat picture = drawMarkers(grey, camera, markers, 0);
  const auto purple = [&](double right) {
    const cv::Vec3b& c =
        picture.at<cv::Vec3b>(std::lround(corner.y()), std::lround(corner.x() - 0.6 + right));
    return c[0] > 180 && c[1] < 130 && c[2] > 180;
  };
  EXPECT_TRUE(purple(15));
  EXPECT_TRUE(purple(28));
  EXPECT_FALSE(purple(33));
}

TEST(MarkerPicture, ScalesToTheAskedWidth) {
  const CameraModel camera(testCalibrations()[0], CameraModel::Image::raw);
  const cv::Mat grey(480, 640, CV_8UC1, cv::Scalar(100));
  EXPECT_EQ(drawMarkers(grey, camera, oneMarker(camera), 320).size(), cv::Size(320, 240));
  EXPECT_EQ(drawMarkers(grey, camera, {}, 1280).size(), cv::Size(1280, 960));
}

}  // namespace
}  // namespace sextant
