// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "surf.hpp"

#include <dlib/image_keypoint.h>
#include <dlib/opencv/cv_image.h>

#include <algorithm>
#include <cmath>

namespace sextant {
namespace {

// Octaves, intervals and first step of the pyramid of dlib's own get_surf_points().
constexpr long OCTAVES = 4, INTERVALS = 6, FIRST_STEP = 2;
constexpr double EXTENT = 32;  // what dlib's descriptor sees of the picture, in scales

/// Sums of the picture over rectangles; dlib's own can neither be copied nor moved.
struct Integral : dlib::integral_image {
  explicit Integral(const cv::Mat& image) { load(dlib::cv_image<unsigned char>(image)); }
};

bool canBeDescribed(const dlib::integral_image& sums, const dlib::vector<double, 2>& centre, double scale) {
  const auto extent = static_cast<unsigned long>(EXTENT * scale);
  return dlib::get_rect(sums).contains(dlib::centered_rect(centre, extent, extent));
}

}  // namespace

std::vector<cv::KeyPoint> detectSurf(const cv::Mat& image, double threshold, bool upright) {
  const Integral sums(image);
  dlib::hessian_pyramid pyramid;
  pyramid.build_pyramid(sums, OCTAVES, INTERVALS, FIRST_STEP);
  std::vector<dlib::interest_point> points;
  dlib::get_interest_points(pyramid, threshold, points);
  std::sort(points.rbegin(), points.rend());  // by score
  std::vector<cv::KeyPoint> keypoints;
  for (const dlib::interest_point& point : points) {
    if (!canBeDescribed(sums, point.center, point.scale)) continue;
    const double angle = upright ? 0 : dlib::compute_dominant_angle(sums, point.center, point.scale);
    keypoints.emplace_back(static_cast<float>(point.center.x()), static_cast<float>(point.center.y()),
                           static_cast<float>(2 * point.scale),
                           static_cast<float>(std::fmod(angle * 180 / CV_PI + 360, 360)),
                           static_cast<float>(point.score));
  }
  return keypoints;
}

cv::Mat describeSurf(const cv::Mat& image, std::vector<cv::KeyPoint>& keypoints) {
  const Integral sums(image);
  keypoints.erase(std::remove_if(keypoints.begin(), keypoints.end(),
                                 [&](const cv::KeyPoint& point) {
                                   return !canBeDescribed(sums, {point.pt.x, point.pt.y}, point.size / 2);
                                 }),
                  keypoints.end());
  cv::Mat descriptors(static_cast<int>(keypoints.size()), 64, CV_32F);
  dlib::matrix<double, 64, 1> descriptor;
  for (int i = 0; i < descriptors.rows; ++i) {
    const cv::KeyPoint& point = keypoints[i];
    const dlib::vector<double, 2> centre(point.pt.x, point.pt.y);
    dlib::compute_surf_descriptor(sums, centre, point.size / 2, point.angle * CV_PI / 180, descriptor);
    std::copy(descriptor.begin(), descriptor.end(), descriptors.ptr<float>(i));
  }
  return descriptors;
}

}  // namespace sextant
