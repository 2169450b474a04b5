// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "code_reader.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace sextant {
namespace {

constexpr int kSamples = 4;  // pixels per module
// Minimum fraction of the modules at the border that are on their side, where the code is blurred, and where
// random bits are often a code.
constexpr double kClearBorder = 0.8, kVeryClearBorder = 0.95;
constexpr double kMinCodeContrast = 5;  // grey levels
constexpr double kMinCodeClarity = 0.7, kSharpCode = 0.9, kBlurredCode = 0.15;
// Probability that random bits are one of the codes, above which a code alone is no evidence of a marker.
constexpr double kMaxCodeChance = 1e-4;

// Probability that random bits are one of the codes, turned any way, after correction.
double codeChance(const cv::aruco::Dictionary& dictionary, double correction_rate) {
  const int bits = dictionary.markerSize * dictionary.markerSize;
  const int corrected = static_cast<int>(dictionary.maxCorrectionBits * correction_rate);
  double neighbours = 0, combinations = 1;
  for (int k = 0; k <= corrected; ++k) {
    neighbours += combinations;
    combinations *= static_cast<double>(bits - k) / (k + 1);
  }
  return 4 * dictionary.bytesList.rows * neighbours / std::exp2(bits);
}

// The book of a dictionary; its prints have a white border around the black one.
CodeBook bookOf(const cv::aruco::Dictionary& dictionary) {
  const int side = dictionary.markerSize, width = side + 4;
  Eigen::MatrixXf prints(dictionary.bytesList.rows, width * width);
  std::vector<cv::Point> bits;
  for (int i = 0; i < side * side; ++i) bits.emplace_back(2 + i % side, 2 + i / side);
  for (int id = 0; id < prints.rows(); ++id) {
    cv::Mat print;
    cv::copyMakeBorder(arucoModules(dictionary, id), print, 1, 1, 1, 1, cv::BORDER_CONSTANT, 255);
    for (int i = 0; i < width * width; ++i)
      prints(id, i) = print.at<uchar>(i / width, i % width) > 0 ? 1.0F : 0;
  }
  return {prints, width, bits};
}

}  // namespace

CodeReader::CodeReader(const cv::aruco::Dictionary& dictionary,
                       const cv::aruco::DetectorParameters& parameters)
    : dictionary_(dictionary),
      parameters_(parameters),
      weak_(codeChance(dictionary, parameters.errorCorrectionRate) > kMaxCodeChance),
      book_(bookOf(dictionary)) {}

Code CodeReader::read(const cv::Mat& image, const std::array<cv::Point2f, 4>& corners) {
  if (!flatten(image, corners)) return {};
  Code code = readBits();
  if (weak_ && !isVeryClear()) code.id = -1;
  if (code.id >= 0 || !isBlurred()) return code;
  if (const auto match = book_.match(greys())) {
    code.id = match->id;
    code.rotation = (4 - match->rotation) % 4;
  }
  return code;
}

bool CodeReader::trusts(const cv::Mat& image, const std::array<cv::Point2f, 4>& corners) {
  return !weak_ || (flatten(image, corners) && isVeryClear());
}

bool CodeReader::shows(const cv::Mat& image, const std::array<cv::Point2f, 4>& corners, int id) {
  if (!flatten(image, corners)) return false;
  const Code code = readBits();
  if (code.id >= 0) return code.id == id && code.rotation == 0;
  return isBlurred() && book_.resembles(greys(), id);
}

// With one module around the border.
bool CodeReader::flatten(const cv::Mat& image, const std::array<cv::Point2f, 4>& corners) {
  const int width = kSamples * (dictionary_.markerSize + 4);
  const float begin = kSamples - 0.5F, end = static_cast<float>(width - kSamples) - 0.5F;
  const std::array<cv::Point2f, 4> square = {
      cv::Point2f{begin, begin}, {end, begin}, {end, end}, {begin, end}};
  cv::warpPerspective(image, flat_, cv::getPerspectiveTransform(square.data(), corners.data()),
                      {width, width}, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  cv::Scalar mean, deviation;
  cv::meanStdDev(marker(), mean, deviation);
  return deviation[0] >= parameters_.minOtsuStdDev;
}

cv::Mat CodeReader::marker() const {
  return flat_(cv::Rect({kSamples, kSamples}, flat_.size() - cv::Size(2 * kSamples, 2 * kSamples)));
}

Code CodeReader::readBits() {
  const int inner = dictionary_.markerSize, width = inner + 2;
  cv::threshold(marker(), binary_, 0, 255, cv::THRESH_BINARY | cv::THRESH_OTSU);
  cv::resize(binary_, modules_, {width, width}, 0, 0, cv::INTER_AREA);
  cv::threshold(modules_, modules_, 127, 1, cv::THRESH_BINARY);
  const cv::Mat bits = modules_({1, 1, inner, inner});
  const int errors = cv::countNonZero(modules_) - cv::countNonZero(bits);
  Code code;
  code.dark_border = 1 - errors / (4.0 * (width - 1));
  if (errors > parameters_.maxErroneousBitsInBorderRate * inner * inner) return code;
  int id;
  if (dictionary_.identify(bits, id, code.rotation, parameters_.errorCorrectionRate)) code.id = id;
  return code;
}

// Mean of the four samples in the middle of a module.
float CodeReader::grey(int column, int row) const {
  const int x = kSamples * column + kSamples / 2, y = kSamples * row + kSamples / 2;
  const uchar *above = flat_.ptr(y - 1) + x, *below = flat_.ptr(y) + x;
  return static_cast<float>(above[-1] + above[0] + below[-1] + below[0]) / 4;
}

Eigen::VectorXf CodeReader::greys() const {
  const int inner = dictionary_.markerSize;
  Eigen::VectorXf greys(inner * inner);
  for (int i = 0; i < inner * inner; ++i) greys[i] = grey(2 + i % inner, 2 + i / inner);
  return greys;
}

// The modules along all four sides, in this distance from the outermost ones.
Eigen::VectorXf CodeReader::ring(int inset) const {
  const int last = dictionary_.markerSize + 3 - inset, count = last - inset;
  Eigen::VectorXf ring(4 * count);
  for (int k = 0; k < count; ++k)
    ring.segment<4>(4 * k) << grey(inset + k, inset), grey(last, inset + k), grey(last - k, last),
        grey(inset, last - k);
  return ring;
}

bool CodeReader::isVeryClear() const { return border() >= kVeryClearBorder && clarity() >= kMinCodeClarity; }

// Whether the CodeBook decides: the bits of a clear print are those that it shows.
bool CodeReader::isBlurred() const {
  return parameters_.errorCorrectionRate > 0 && border() >= kClearBorder && clarity() >= kBlurredCode &&
         clarity() < kSharpCode;
}

// See TagReading.
float CodeReader::clarity() const {
  const float light = ring(0).mean(), dark = ring(1).mean();
  const Eigen::ArrayXf offsets = greys().array() - 0.5F * (light + dark);
  const auto mean = [&](const Eigen::Array<bool, Eigen::Dynamic, 1>& chosen) {
    return chosen.select(offsets.abs(), 0).sum() /
           static_cast<float>(std::max<Eigen::Index>(1, chosen.count()));
  };
  return std::min(mean(offsets > 0), mean(offsets <= 0)) / (0.5F * (light - dark));
}

// Fraction of the dark modules of the border and of the light ones around it that are on their side of the
// mean.
double CodeReader::border() const {
  const Eigen::VectorXf light = ring(0), dark = ring(1);
  if (light.mean() - dark.mean() < kMinCodeContrast) return 0;
  const float threshold = 0.5F * (light.mean() + dark.mean());
  const auto right = (light.array() > threshold).count() + (dark.array() < threshold).count();
  return static_cast<double>(right) / static_cast<double>(light.size() + dark.size());
}

}  // namespace sextant
