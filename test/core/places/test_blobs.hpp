// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "sextant/places/local_features.hpp"

namespace sextant {

/// Similarity transform between two image planes.
struct Similarity {
  double scale = 1, angle = 0;
  cv::Point2d shift;

  cv::Point2d operator*(const cv::Point2d& p) const {
    const double c = scale * std::cos(angle), s = scale * std::sin(angle);
    return {c * p.x - s * p.y + shift.x, s * p.x + c * p.y + shift.y};
  }
};

inline Similarity aboutPoint(const cv::Point2d& fixed, double scale, double angle) {
  return {scale, angle, fixed - Similarity{scale, angle, {}} * fixed};
}

/// A Gaussian blob stays one under a similarity, so the transformed image is known exactly.
struct Blob {
  cv::Point2d centre;
  double sigma, grey;
};

inline cv::Mat blobImage(const std::vector<Blob>& scene, const cv::Size& size,
                         const Similarity& T_image_scene = {}) {
  cv::Mat_<float> image(size, 128.0F);
  for (const Blob& blob : scene) {
    const cv::Point2d centre = T_image_scene * blob.centre;
    const double sigma = blob.sigma * T_image_scene.scale;
    const auto reach = static_cast<int>(5 * sigma);
    const cv::Rect around(cv::Point(centre) - cv::Point(reach, reach), cv::Size(2 * reach, 2 * reach));
    const cv::Rect part = around & cv::Rect({0, 0}, size);
    for (int y = part.y; y < part.y + part.height; ++y)
      for (int x = part.x; x < part.x + part.width; ++x) {
        const cv::Point2d off = cv::Point2d(x, y) - centre;
        image(y, x) += static_cast<float>(blob.grey * std::exp(-off.dot(off) / (2 * sigma * sigma)));
      }
  }
  cv::Mat grey;
  image.convertTo(grey, CV_8U);
  return grey;
}

/// Dense enough for every detector, in a square from (-100, -100) to (420, 420).
inline std::vector<Blob> randomScene() {
  std::vector<Blob> scene;
  cv::RNG random(4);
  for (int i = 0; i < 900; ++i) {
    const double x = random.uniform(-100.0, 420.0), y = random.uniform(-100.0, 420.0);
    const double sigma = random.uniform(1.3, 7.0);
    scene.push_back({{x, y}, sigma, random.uniform(-90.0, 90.0)});
  }
  return scene;
}

inline int nearestDescriptor(const cv::Mat& descriptor, const cv::Mat& all) {
  const auto distance = [&](int row) {
    return cv::norm(descriptor, all.row(row), all.type() == CV_8U ? cv::NORM_HAMMING : cv::NORM_L2);
  };
  int best = 0;
  for (int row = 1; row < all.rows; ++row)
    if (distance(row) < distance(best)) best = row;
  return best;
}

/// How keypoints of an image, except those near the border, are matched in another image of the scene.
struct Agreement {
  double repeated = 0;  // share of keypoints detected in both images
  double matched = 0;   // share of these with a correct nearest descriptor
  cv::Point2d bias;     // mean position error, pixels of the other image
};

inline Agreement agreement(const LocalFeatures& a, const LocalFeatures& b, const Similarity& T_b_a) {
  constexpr int kBorder = 40;
  const cv::Rect2d inner(kBorder, kBorder, b.size.width - 2 * kBorder, b.size.height - 2 * kBorder);
  const double near = 1.5 * std::max(1.0, T_b_a.scale);
  int seen = 0, repeated = 0, matched = 0;
  cv::Point2d sum;
  for (size_t i = 0; i < a.keypoints.size(); ++i) {
    const cv::Point2d there = T_b_a * cv::Point2d(a.keypoints[i].pt);
    if (!inner.contains(there)) continue;
    ++seen;
    const auto off = [&](const cv::KeyPoint& point) { return cv::norm(cv::Point2d(point.pt) - there); };
    const auto closest = std::min_element(b.keypoints.begin(), b.keypoints.end(),
                                          [&](const auto& p, const auto& q) { return off(p) < off(q); });
    if (closest == b.keypoints.end() || off(*closest) > near) continue;
    ++repeated;
    sum += cv::Point2d(closest->pt) - there;
    const int match = nearestDescriptor(a.descriptors.row(static_cast<int>(i)), b.descriptors);
    matched += off(b.keypoints[match]) <= near;
  }
  return {static_cast<double>(repeated) / seen, static_cast<double>(matched) / repeated, sum / repeated};
}

}  // namespace sextant
