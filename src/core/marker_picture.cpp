// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/core/marker_picture.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

namespace sextant {
namespace {

const cv::Scalar kOutline(0, 220, 255), kText(0, 220, 255), kShadow(0, 0, 0);
const cv::Scalar kAxes[3] = {{60, 60, 255}, {60, 220, 60}, {255, 120, 40}};
constexpr int kShift = 4;  // cv's fixed-point bits: drawing at 1/16 pixel

// Draws in pixels of the full image onto a picture that may be smaller.
class Pen {
 public:
  Pen(cv::Mat& picture, double scale)
      : picture_(picture),
        scale_(scale),
        thickness_(std::max(1, static_cast<int>(std::lround(picture.cols / 640.0)))) {}

  void line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const cv::Scalar& colour) {
    cv::line(picture_, fixed(a), fixed(b), colour, thickness_, cv::LINE_AA, kShift);
  }
  void text(const Eigen::Vector2d& at, const std::string& text) {
    const Eigen::Vector2d p = scaled(at);
    const cv::Point place(static_cast<int>(p.x()), static_cast<int>(p.y()));
    const double height = 0.45 * thickness_;
    cv::putText(picture_, text, place, cv::FONT_HERSHEY_SIMPLEX, height, kShadow, 3 * thickness_,
                cv::LINE_AA);
    cv::putText(picture_, text, place, cv::FONT_HERSHEY_SIMPLEX, height, kText, thickness_, cv::LINE_AA);
  }

 private:
  // The centre of the first pixel is (0, 0) at either size.
  Eigen::Vector2d scaled(const Eigen::Vector2d& p) const {
    return (scale_ * (p.array() + 0.5) - 0.5).max(-1e5).min(1e5).matrix();
  }
  cv::Point fixed(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d q = scaled(p) * (1 << kShift);
    return {static_cast<int>(q.x()), static_cast<int>(q.y())};
  }

  cv::Mat& picture_;
  double scale_;
  int thickness_;
};

void drawAxes(Pen& pen, const CameraModel& camera, const ObservedMarker& marker) {
  const Pose& T = marker.poses->best.T_camera_marker;
  const auto origin = camera.project(T.translation());
  for (int axis = 0; axis < 3 && origin; ++axis) {
    const auto tip = camera.project(T * (0.5 * marker.size * Eigen::Vector3d::Unit(axis)));
    if (tip) pen.line(*origin, *tip, kAxes[axis]);
  }
}

void drawMarker(Pen& pen, const CameraModel& camera, const ObservedMarker& marker) {
  const Corners& corners = marker.detection.corners;
  for (int i = 0; i < 4; ++i) pen.line(corners[i], corners[(i + 1) % 4], kOutline);
  if (marker.poses) drawAxes(pen, camera, marker);
  Eigen::Vector2d above = corners[0];
  for (const auto& corner : corners)
    above = {std::min(above.x(), corner.x()), std::min(above.y(), corner.y())};
  pen.text(above - Eigen::Vector2d(0, 6), std::to_string(marker.detection.key.id));
}

}  // namespace

cv::Mat drawMarkers(const cv::Mat& grey, const CameraModel& camera,
                    const std::vector<ObservedMarker>& markers, int width) {
  const double scale = width > 0 ? static_cast<double>(width) / grey.cols : 1.0;
  cv::Mat picture;
  if (scale != 1.0)
    cv::resize(grey, picture, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
  else
    picture = grey;
  cv::Mat colour;
  cv::cvtColor(picture, colour, cv::COLOR_GRAY2BGR);
  Pen pen(colour, scale);
  for (const ObservedMarker& marker : markers) drawMarker(pen, camera, marker);
  return colour;
}

}  // namespace sextant
