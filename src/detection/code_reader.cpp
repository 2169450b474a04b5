// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "code_reader.hpp"

#include <opencv2/imgproc.hpp>

namespace sextant {
namespace {

constexpr int kSamples = 4;  // pixels per module

}  // namespace

CodeReader::CodeReader(const cv::aruco::Dictionary& dictionary,
                       const cv::aruco::DetectorParameters& parameters)
    : dictionary_(dictionary), parameters_(parameters) {}

Code CodeReader::read(const cv::Mat& image, const std::array<cv::Point2f, 4>& corners) {
  const int inner = dictionary_.markerSize, width = inner + 2;
  const float begin = -0.5F, end = static_cast<float>(kSamples * width) - 0.5F;
  const std::array<cv::Point2f, 4> square = {
      cv::Point2f{begin, begin}, {end, begin}, {end, end}, {begin, end}};
  cv::warpPerspective(image, flat_, cv::getPerspectiveTransform(square.data(), corners.data()),
                      {kSamples * width, kSamples * width}, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                      cv::BORDER_REPLICATE);
  cv::Scalar mean, deviation;
  cv::meanStdDev(flat_, mean, deviation);
  if (deviation[0] < parameters_.minOtsuStdDev) return {};
  cv::threshold(flat_, flat_, 0, 255, cv::THRESH_BINARY | cv::THRESH_OTSU);
  cv::resize(flat_, modules_, {width, width}, 0, 0, cv::INTER_AREA);
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

}  // namespace sextant
