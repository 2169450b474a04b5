// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/marker_picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>

namespace sextant {
namespace {

const cv::Scalar kOutline(0, 220, 255), kText(0, 220, 255), kShadow(0, 0, 0);
const cv::Scalar kResidual(255, 80, 255);
const cv::Scalar kAxes[3] = {{60, 60, 255}, {60, 220, 60}, {255, 120, 40}};
constexpr double kEnlarged = 50;  // residuals are parts of a pixel
constexpr int kShift = 4;         // cv's fixed-point bits: drawing at 1/16 pixel

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
    textAt({static_cast<int>(p.x()), static_cast<int>(p.y())}, text, kText);
  }
  // In the picture's lower left corner.
  void footnote(const std::string& text, const cv::Scalar& colour) {
    textAt({6 * thickness_, picture_.rows - 8 * thickness_}, text, colour);
  }

 private:
  // What stands over the edge is moved into the picture.
  void textAt(cv::Point place, const std::string& text, const cv::Scalar& colour) {
    const double height = 0.45 * thickness_;
    const cv::Size size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, height, thickness_, nullptr);
    place.x = std::max(2, std::min(place.x, picture_.cols - size.width - 2));
    place.y = std::max(size.height + 2, std::min(place.y, picture_.rows - 2));
    for (const auto& [tint, width] : {std::pair(kShadow, thickness_ + 2), std::pair(colour, thickness_)})
      cv::putText(picture_, text, place, cv::FONT_HERSHEY_SIMPLEX, height, tint, width, cv::LINE_AA);
  }

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

// From where a corner is seen to where the pose has it, enlarged.
void drawResiduals(Pen& pen, const CameraModel& camera, const ObservedMarker& marker) {
  const auto board = markerCorners(marker.size);
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d& seen = marker.detection.corners[i];
    const auto expected = camera.project(marker.poses->best.T_camera_marker * board[i]);
    if (expected) pen.line(seen, seen + kEnlarged * (*expected - seen), kResidual);
  }
}

void drawLegend(Pen& pen, const std::vector<ObservedMarker>& markers) {
  double squares = 0.0;
  int posed = 0;
  for (const ObservedMarker& marker : markers) {
    if (!marker.poses) continue;
    squares += std::pow(marker.poses->best.reprojection_error, 2);
    ++posed;
  }
  if (posed == 0) return;
  char text[64];
  std::snprintf(text, sizeof text, "residuals x %.0f, RMS %.3f px", kEnlarged, std::sqrt(squares / posed));
  pen.footnote(text, kResidual);
}

void drawMarker(Pen& pen, const CameraModel& camera, const ObservedMarker& marker) {
  const Corners& corners = marker.detection.corners;
  for (int i = 0; i < 4; ++i) pen.line(corners[i], corners[(i + 1) % 4], kOutline);
  if (marker.poses) {
    drawAxes(pen, camera, marker);
    drawResiduals(pen, camera, marker);
  }
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
  drawLegend(pen, markers);
  return colour;
}

}  // namespace sextant
