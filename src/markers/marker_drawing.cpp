// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/markers/marker_drawing.hpp"

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
constexpr double kResidualScale = 50;  // factor on the residuals, which are fractions of a pixel
constexpr int kShift = 4;              // OpenCV's fixed-point bits: drawing at 1/16 pixel

// Draws in pixel coordinates of the full image onto a drawing that may be smaller.
class Pen {
 public:
  Pen(cv::Mat& drawing, double scale)
      : drawing_(drawing),
        scale_(scale),
        thickness_(std::max(1, static_cast<int>(std::lround(drawing.cols / 640.0)))) {}

  void line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const cv::Scalar& colour) {
    cv::line(drawing_, fixed(a), fixed(b), colour, thickness_, cv::LINE_AA, kShift);
  }
  void text(const Eigen::Vector2d& at, const std::string& text) {
    const Eigen::Vector2d p = scaled(at);
    textAt({static_cast<int>(p.x()), static_cast<int>(p.y())}, text, kText);
  }
  // Writes into the lower left corner of the drawing.
  void footnote(const std::string& text, const cv::Scalar& colour) {
    textAt({6 * thickness_, drawing_.rows - 8 * thickness_}, text, colour);
  }

 private:
  // Writes text; moves it inside if it would extend beyond the border.
  void textAt(cv::Point place, const std::string& text, const cv::Scalar& colour) {
    const double font_scale = 0.45 * thickness_;
    const cv::Size size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, font_scale, thickness_, nullptr);
    place.x = std::max(2, std::min(place.x, drawing_.cols - size.width - 2));
    place.y = std::max(size.height + 2, std::min(place.y, drawing_.rows - 2));
    for (const auto& [tint, width] : {std::pair(kShadow, thickness_ + 2), std::pair(colour, thickness_)})
      cv::putText(drawing_, text, place, cv::FONT_HERSHEY_SIMPLEX, font_scale, tint, width, cv::LINE_AA);
  }

  // Pixel coordinates of the drawing. The centre of the first pixel is (0, 0) at both sizes.
  Eigen::Vector2d scaled(const Eigen::Vector2d& p) const {
    return (scale_ * (p.array() + 0.5) - 0.5).max(-1e5).min(1e5).matrix();
  }
  cv::Point fixed(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d q = scaled(p) * (1 << kShift);
    return {static_cast<int>(q.x()), static_cast<int>(q.y())};
  }

  cv::Mat& drawing_;
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

// Draws a line from each detected corner toward its projection by the marker's pose, enlarged.
void drawResiduals(Pen& pen, const CameraModel& camera, const ObservedMarker& marker) {
  const auto board = markerCorners(marker.size);
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector2d& seen = marker.detection.corners[i];
    const auto expected = camera.project(marker.poses->best.T_camera_marker * board[i]);
    if (expected) pen.line(seen, seen + kResidualScale * (*expected - seen), kResidual);
  }
}

void drawLegend(Pen& pen, const std::vector<ObservedMarker>& markers) {
  double squared_errors = 0.0;
  int with_pose = 0;
  for (const ObservedMarker& marker : markers) {
    if (!marker.poses) continue;
    squared_errors += std::pow(marker.poses->best.reprojection_error, 2);
    ++with_pose;
  }
  if (with_pose == 0) return;
  char text[64];
  std::snprintf(text, sizeof text, "residuals x %.0f, RMS %.3f px", kResidualScale,
                std::sqrt(squared_errors / with_pose));
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
  cv::Mat resized;
  if (scale != 1.0)
    cv::resize(grey, resized, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
  else
    resized = grey;
  cv::Mat colour;
  cv::cvtColor(resized, colour, cv::COLOR_GRAY2BGR);
  Pen pen(colour, scale);
  for (const ObservedMarker& marker : markers) drawMarker(pen, camera, marker);
  drawLegend(pen, markers);
  return colour;
}

}  // namespace sextant
