// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sextant/markers/marker.hpp"
#include "sextant/markers/marker_family.hpp"

namespace sextant {

/// Reflectance, 0 to 1, of the surface at a pixel.
using Scene = std::function<double(const Eigen::Vector2d&)>;
/// Intersection of a pixel's ray with a marker's plane: (0, 0) top left and (1, 1) bottom right corner.
using PrintPlace = std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector2d&)>;

/// The print 9 of a family with two modules of white around it on a grey wall.
inline Scene printScene(const PrintPlace& place, const std::string& family = "tag36h11") {
  const MarkerImage marker = markerImage(family, 9);
  const double width = marker.border_end - marker.border_begin;
  return [=](const Eigen::Vector2d& pixel) {
    const auto p = place(pixel);
    if (!p) return 0.5;
    const Eigen::Vector2d module = (*p * width).array() + marker.border_begin;
    const int x = static_cast<int>(std::floor(module.x())), y = static_cast<int>(std::floor(module.y()));
    const int last = marker.modules.cols;
    if (std::min(x, y) < -2 || std::max(x, y) >= last + 2) return 0.5;
    if (std::min(x, y) < 0 || std::max(x, y) >= last) return 1.0;
    return marker.modules.at<uchar>(y, x) / 255.0;
  };
}

/// The same without lens distortion, with these corners.
inline Scene printScene(const Corners& corners, const std::string& family = "tag36h11") {
  std::vector<cv::Point2f> to;
  for (const auto& corner : corners)
    to.emplace_back(static_cast<float>(corner.x()), static_cast<float>(corner.y()));
  const std::vector<cv::Point2f> from = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  const cv::Matx33d H = cv::getPerspectiveTransform(to, from);
  const PrintPlace place = [H](const Eigen::Vector2d& pixel) {
    const cv::Vec3d p = H * cv::Vec3d(pixel.x(), pixel.y(), 1);
    return std::optional<Eigen::Vector2d>(Eigen::Vector2d(p[0] / p[2], p[1] / p[2]));
  };
  return printScene(place, family);
}

struct Exposure {
  cv::Size size = {160, 120};
  double noise = 2;   // grey levels
  double blur = 0.7;  // pixels
  int seed = 6;
  int supersampling = 6;
};

/// Grey levels 40 to 193, every pixel the mean of supersampling^2 samples.
inline cv::Mat photograph(const Scene& scene, const Exposure& exposure) {
  const int n = exposure.supersampling;
  cv::Mat_<float> image(exposure.size, 0.0F), noise(exposure.size);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      double sum = 0;
      for (int i = 0; i < n * n; ++i)
        sum += scene({x - 0.5 + (i % n + 0.5) / n, y - 0.5 + (i / n + 0.5) / n});
      image(y, x) = static_cast<float>(40 + 153 * sum / (n * n));
    }
  cv::GaussianBlur(image, image, {}, exposure.blur);
  cv::RNG random(exposure.seed);
  random.fill(noise, cv::RNG::NORMAL, 0, exposure.noise);
  cv::Mat grey;
  cv::Mat(image + noise).convertTo(grey, CV_8UC1);
  return grey;
}

}  // namespace sextant
