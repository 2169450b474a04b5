// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/places/local_features.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <set>
#include <stdexcept>
#include <string_view>
#include <tuple>

#include "surf.hpp"

namespace sextant {
namespace {

using KeyPoints = std::vector<cv::KeyPoint>;

constexpr int kMinSide = 8;  // pixels; OpenCV's AKAZE throws for smaller images

// OpenCV's ORB
constexpr int kOrbFeatures = 500, kOrbLevels = 8, kOrbPatch = 31;
constexpr float kOrbScale = 1.2F;

// OpenCV's SIFT
constexpr double kSiftSigma = 1.6;  // of the first layer of an octave
constexpr int kSiftLayers = 3;      // per octave
constexpr double kSiftEdge = 10;    // minimum ratio of principal curvatures of an edge
constexpr float kSiftUnit = 512;    // integer value of 1 in a unit descriptor

cv::Ptr<cv::Feature2D> sift(const FeatureParams& params) {
  return cv::SIFT::create(0, kSiftLayers, params.sift_contrast, kSiftEdge, kSiftSigma);
}

cv::Ptr<cv::Feature2D> orb(const FeatureParams& params) {
  return cv::ORB::create(params.max_features ? params.max_features : kOrbFeatures, kOrbScale, kOrbLevels,
                         kOrbPatch, 0, params.orb_wta_k);
}

cv::Ptr<cv::Feature2D> akaze(const FeatureParams& params) {
  const auto type = params.upright ? cv::AKAZE::DESCRIPTOR_MLDB_UPRIGHT : cv::AKAZE::DESCRIPTOR_MLDB;
  return cv::AKAZE::create(type, 0, 3, static_cast<float>(params.akaze_threshold));
}

template <cv::Ptr<cv::Feature2D> Create(const FeatureParams&)>
KeyPoints detectBy(const FeatureParams& params, const cv::Mat& image) {
  KeyPoints keypoints;
  Create(params)->detect(image, keypoints);
  return keypoints;
}

KeyPoints detectBySurf(const FeatureParams& params, const cv::Mat& image) {
  return detectSurf(image, params.surf_threshold, params.upright);
}

/// The coarsest octave of SIFT's pyramid that has at least kMinSide pixels.
int topOctave(const cv::Mat& image) {
  return static_cast<int>(std::log2(std::min(image.rows, image.cols) / kMinSide));
}

/// The octave and layer of SIFT's pyramid for a keypoint size in pixels, packed as OpenCV does.
int siftOctave(double size, int top) {
  const double level = std::log2(size / (2 * kSiftSigma));
  const int octave = std::clamp(static_cast<int>(std::ceil(level)) - 1, -1, top);
  const int layer = std::clamp(static_cast<int>(std::lround((level - octave) * kSiftLayers)), 1, kSiftLayers);
  return (octave & 255) | (layer << 8);
}

/// Describes a keypoint one octave up: with twice the support region the sampling density stays the same, at
/// a quarter of the cost.
void moveOctaveUp(cv::KeyPoint& point, int top) {
  const int octave = static_cast<int8_t>(point.octave & 255);
  if (octave < top) point.octave = (point.octave & ~255) | ((octave + 1) & 255);
}

cv::Mat describeBySift(const FeatureParams& params, const cv::Mat& image, KeyPoints& keypoints) {
  const int top = topOctave(image);
  // SIFT's lowest octave is the image at double size: the most expensive one, needed by small images only.
  const bool up =
      params.support_scale >= 2 && params.max_side && 2 * std::max(image.cols, image.rows) > params.max_side;
  for (cv::KeyPoint& point : keypoints) {
    if (params.detector != "SIFT") point.octave = siftOctave(point.size / params.support_scale, top);
    if (up) moveOctaveUp(point, top);
  }
  cv::Mat descriptors;
  sift(params)->compute(image, keypoints, descriptors);
  if (params.root_sift)
    for (int i = 0; i < descriptors.rows; ++i) {
      cv::Mat row = descriptors.row(i);
      cv::sqrt(row / std::max(cv::norm(row, cv::NORM_L1), 1e-9), row);  // Arandjelovic, Zisserman, CVPR 2012
      for (float& value : cv::Mat_<float>(row)) value = std::min(std::round(kSiftUnit * value), 255.0F);
    }
  return descriptors;
}

cv::Mat describeBySurf(const FeatureParams&, const cv::Mat& image, KeyPoints& keypoints) {
  return describeSurf(image, keypoints);
}

cv::Mat describeByOrb(const FeatureParams& params, const cv::Mat& image, KeyPoints& keypoints) {
  if (params.detector != "ORB")
    for (cv::KeyPoint& point : keypoints)
      point.octave =
          std::clamp(static_cast<int>(std::lround(std::log(point.size / kOrbPatch) / std::log(kOrbScale))), 0,
                     kOrbLevels - 1);
  cv::Mat descriptors;
  orb(params)->compute(image, keypoints, descriptors);
  return descriptors;
}

cv::Mat describeByAkaze(const FeatureParams& params, const cv::Mat& image, KeyPoints& keypoints) {
  cv::Mat descriptors;
  akaze(params)->compute(image, keypoints, descriptors);
  return descriptors;
}

struct Method {
  KeyPoints (*detect)(const FeatureParams&, const cv::Mat&);
  // Removes keypoints that it cannot describe.
  cv::Mat (*describe)(const FeatureParams&, const cv::Mat&, KeyPoints&);
  bool binary;
  int descriptor_width;
  bool scalable;  // whether the support region follows the keypoint's size
};

const std::map<std::string, Method>& methods() {
  static const std::map<std::string, Method> all = {
      {"AKAZE", {detectBy<akaze>, describeByAkaze, true, 61, false}},
      {"ORB", {detectBy<orb>, describeByOrb, true, 32, false}},
      {"SIFT", {detectBy<sift>, describeBySift, false, 128, true}},
      {"SURF", {detectBySurf, describeBySurf, false, 64, true}},
  };
  return all;
}

const Method& method(std::string_view what, const std::string& name) {
  const auto found = methods().find(name);
  if (found != methods().end()) return found->second;
  std::string names;
  for (const std::string& known : featureNames()) names += (names.empty() ? "" : ", ") + known;
  throw std::invalid_argument(std::string(what) + " is '" + name + "', it must be one of " + names);
}

cv::Mat reduced(const cv::Mat& image, int max_side) {
  const int side = std::max(image.cols, image.rows);
  if (!max_side || side <= max_side) return image;
  const double factor = static_cast<double>(max_side) / side;
  cv::Mat smaller;
  cv::resize(image, smaller,
             {std::max(1, static_cast<int>(std::lround(image.cols * factor))),
              std::max(1, static_cast<int>(std::lround(image.rows * factor)))},
             0, 0, cv::INTER_AREA);
  return smaller;
}

/// Detectors repeat a keypoint for each of its orientations; keeps the first.
void makeUpright(KeyPoints& keypoints) {
  std::set<std::tuple<float, float, float>> seen;
  KeyPoints kept;
  for (cv::KeyPoint& point : keypoints) {
    if (!seen.emplace(point.pt.x, point.pt.y, point.size).second) continue;
    point.angle = 0;
    kept.push_back(point);
  }
  keypoints.swap(kept);
}

void keepStrongest(KeyPoints& keypoints, size_t count) {
  if (keypoints.size() <= count) return;
  std::stable_sort(keypoints.begin(), keypoints.end(),
                   [](const cv::KeyPoint& a, const cv::KeyPoint& b) { return a.response > b.response; });
  keypoints.resize(count);
}

void scaleSizes(KeyPoints& keypoints, double factor) {
  for (cv::KeyPoint& point : keypoints) point.size *= static_cast<float>(factor);
}

/// Converts keypoints from a reduced image to the original; the scales differ as sides are rounded to pixels.
void enlarge(KeyPoints& keypoints, const cv::Size& from, const cv::Size& to) {
  const double x = static_cast<double>(to.width) / from.width,
               y = static_cast<double>(to.height) / from.height;
  for (cv::KeyPoint& point : keypoints)  // 0 is the centre of the first pixel
    point.pt = cv::Point2d((point.pt.x + 0.5) * x - 0.5, (point.pt.y + 0.5) * y - 0.5);
  scaleSizes(keypoints, std::sqrt(x * y));
}

KeyPoints detect(const FeatureParams& params, const cv::Mat& image) {
  if (std::min(image.rows, image.cols) < kMinSide) return {};
  KeyPoints keypoints = method("detector", params.detector).detect(params, image);
  if (params.upright) makeUpright(keypoints);
  keypoints.erase(std::remove_if(keypoints.begin(), keypoints.end(),
                                 [&](const cv::KeyPoint& point) { return point.size < params.min_size; }),
                  keypoints.end());
  if (params.max_features) keepStrongest(keypoints, params.max_features);
  return keypoints;
}

}  // namespace

FeatureParams FeatureParams::plain(const std::string& detector, const std::string& extractor) {
  FeatureParams params;
  params.detector = detector;
  params.extractor = extractor;
  params.max_side = 0;
  params.max_features = 0;
  params.upright = false;
  params.root_sift = false;
  params.support_scale = 1;
  params.sift_contrast = 0.04;
  return params;
}

ParamList FeatureParams::fields() {
  const auto is_method = [](const Param& param) { method(param.name, *std::get<std::string*>(param.value)); };
  const auto fits = [this](const Param& param) {
    method(param.name, extractor);
    if (extractor == "AKAZE" && detector != "AKAZE")
      throw std::invalid_argument("extractor AKAZE needs detector AKAZE, it is " + detector);
  };
  return {
      {"detector", &detector, Allowed("AKAZE, ORB, SIFT, SURF", is_method), "",
       "keypoint detector; SURF is dlib's"},
      {"extractor", &extractor, Allowed("AKAZE, ORB, SIFT, SURF", fits), "",
       "descriptor extractor; AKAZE needs keypoints of AKAZE"},
      {"max_side", &max_side, Range::closed(0, 16384), "px",
       "longer side to which images are reduced; 0: no limit"},
      {"min_size", &min_size, Range::closed(0, 1000), "px",
       "minimum size of a keypoint in the reduced image"},
      {"max_features", &max_features, Range::closed(0, 1000000), "",
       "maximum number of keypoints per image, the strongest ones; 0: all (ORB: 500)"},
      {"upright", &upright, Allowed(), "", "ignore keypoint orientation"},
      {"root_sift", &root_sift, Allowed(), "", "SIFT: use RootSIFT descriptors"},
      {"support_scale", &support_scale, Range::openLow(0, 16), "",
       "SIFT, SURF: size of the described region relative to the usual one"},
      {"sift_contrast", &sift_contrast, Range::openLow(0, 1), "",
       "SIFT: minimum contrast of a keypoint; OpenCV's default is 0.04"},
      {"surf_threshold", &surf_threshold, Range::openLow(0, 1e6), "",
       "SURF: minimum score of a keypoint, on dlib's scale"},
      {"akaze_threshold", &akaze_threshold, Range::openLow(0, 1), "",
       "AKAZE: minimum detector response of a keypoint"},
      {"orb_wta_k", &orb_wta_k, Range::closed(2, 4), "",
       "ORB: points compared per descriptor element; 3 and 4 need BruteForce-Hamming(2)"},
  };
}

std::vector<std::string> featureNames() {
  std::vector<std::string> names;
  for (const auto& [name, each] : methods()) names.push_back(name);
  return names;
}

bool isBinaryExtractor(const std::string& extractor) { return method("extractor", extractor).binary; }

FeatureExtractor::FeatureExtractor(const FeatureParams& params) : params_(params) { validate(params_); }

LocalFeatures FeatureExtractor::extract(const cv::Mat& image) const {
  if (image.type() != CV_8UC1 || image.empty())
    throw std::invalid_argument("FeatureExtractor: the image must be 8-bit grey and not empty");
  const Method& extractor = method("extractor", params_.extractor);
  const cv::Mat small = reduced(image, params_.max_side);
  KeyPoints keypoints = detect(params_, small);
  const double support = extractor.scalable ? params_.support_scale : 1;
  scaleSizes(keypoints, support);
  LocalFeatures features{image.size(), {}, cv::Mat()};
  if (!keypoints.empty()) features.descriptors = extractor.describe(params_, small, keypoints);
  if (features.descriptors.empty())
    features.descriptors.create(0, extractor.descriptor_width, extractor.binary ? CV_8U : CV_32F);
  scaleSizes(keypoints, 1 / support);
  enlarge(keypoints, small.size(), image.size());
  features.keypoints = std::move(keypoints);
  return features;
}

}  // namespace sextant
