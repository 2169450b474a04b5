// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/images/grey_image.hpp"

#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace sextant {

cv::Mat greyImage(const cv::Mat& image) {
  if (image.type() == CV_8UC1) return image;
  if (image.type() != CV_8UC3 && image.type() != CV_8UC4)
    throw std::invalid_argument("an image must be 8-bit grey, BGR or BGRA");
  cv::Mat grey;
  cv::cvtColor(image, grey, image.channels() == 3 ? cv::COLOR_BGR2GRAY : cv::COLOR_BGRA2GRAY);
  return grey;
}

}  // namespace sextant
