// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "surf.hpp"

#include <dlib/image_keypoint.h>
#include <dlib/opencv/cv_image.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

namespace sextant {
namespace {

// Pyramid of dlib's get_surf_points().
constexpr long kOctaves = 4, kIntervals = 6, kFirstStep = 2;
constexpr double kExtent = 32;       // side of the support region of dlib's descriptor, in scales
constexpr double kAngleExtent = 17;  // side of the region for the dominant angle, in scales

/// Integral image; dlib's can neither be copied nor moved.
struct Integral : dlib::integral_image {
  explicit Integral(const cv::Mat& image) { load(dlib::cv_image<unsigned char>(image)); }
};

/// Scale at which a keypoint is described, at least 1: below, dlib's boxes are empty or outside the image.
double describedScale(const cv::KeyPoint& point) { return std::max(point.size / 2.0, 1.0); }

/// How far the support regions extend beyond the image border, pixels.
int overhang(const cv::Size& size, const std::vector<cv::KeyPoint>& keypoints) {
  double most = 0;
  for (const cv::KeyPoint& point : keypoints) {
    const double x = std::min(point.pt.x, size.width - point.pt.x);
    const double y = std::min(point.pt.y, size.height - point.pt.y);
    most = std::max(most, kExtent / 2 * describedScale(point) - std::min(x, y));
  }
  return static_cast<int>(std::ceil(most)) + 1;  // dlib rounds
}

bool isInside(const dlib::integral_image& sums, const dlib::vector<double, 2>& centre, double extent) {
  const auto side = static_cast<unsigned long>(extent);
  return dlib::get_rect(sums).contains(dlib::centered_rect(centre, side, side));
}

}  // namespace

std::vector<cv::KeyPoint> detectSurf(const cv::Mat& image, double threshold, bool upright) {
  const Integral sums(image);
  dlib::hessian_pyramid pyramid;
  pyramid.build_pyramid(sums, kOctaves, kIntervals, kFirstStep);
  std::vector<dlib::interest_point> points;
  dlib::get_interest_points(pyramid, threshold, points);
  std::sort(points.rbegin(), points.rend());  // by score
  std::vector<cv::KeyPoint> keypoints;
  for (const dlib::interest_point& point : points) {
    if (!upright && !isInside(sums, point.center, kAngleExtent * point.scale)) continue;
    const double angle = upright ? 0 : dlib::compute_dominant_angle(sums, point.center, point.scale);
    keypoints.emplace_back(static_cast<float>(point.center.x()), static_cast<float>(point.center.y()),
                           static_cast<float>(2 * point.scale),
                           static_cast<float>(std::fmod(angle * 180 / CV_PI + 360, 360)),
                           static_cast<float>(point.score));
  }
  return keypoints;
}

cv::Mat describeSurf(const cv::Mat& image, std::vector<cv::KeyPoint>& keypoints) {
  const int margin = std::min(overhang(image.size(), keypoints), std::max(image.cols, image.rows));
  cv::Mat widened;
  cv::copyMakeBorder(image, widened, margin, margin, margin, margin, cv::BORDER_REPLICATE);
  const Integral sums(widened);
  const auto centre = [margin](const cv::KeyPoint& point) {
    return dlib::vector<double, 2>(point.pt.x + margin, point.pt.y + margin);
  };
  const auto is_too_large = [&](const cv::KeyPoint& point) {
    return !isInside(sums, centre(point), kExtent * describedScale(point));
  };
  keypoints.erase(std::remove_if(keypoints.begin(), keypoints.end(), is_too_large), keypoints.end());
  cv::Mat descriptors(static_cast<int>(keypoints.size()), 64, CV_32F);
  dlib::matrix<double, 64, 1> descriptor;
  for (int i = 0; i < descriptors.rows; ++i) {
    const cv::KeyPoint& point = keypoints[i];
    dlib::compute_surf_descriptor(sums, centre(point), describedScale(point), point.angle * CV_PI / 180,
                                  descriptor);
    std::copy(descriptor.begin(), descriptor.end(), descriptors.ptr<float>(i));
  }
  return descriptors;
}

}  // namespace sextant
