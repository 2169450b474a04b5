// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cstring>

#include "casters.hpp"
#include "sextant/core/grey_image.hpp"

namespace sextant {

cv::Mat imageFromArray(const ImageArray& array) {
  const bool grey = array.ndim() == 2, colour = array.ndim() == 3 && array.shape(2) == 3;
  if (!grey && !colour)
    throw pybind11::value_error("an image must be of shape (height, width) or (height, width, 3), BGR");
  const cv::Mat view(static_cast<int>(array.shape(0)), static_cast<int>(array.shape(1)),
                     grey ? CV_8UC1 : CV_8UC3, const_cast<uint8_t*>(array.data()));
  return greyImage(view);
}

pybind11::array_t<uint8_t> arrayFromImage(const cv::Mat& image) {
  pybind11::array_t<uint8_t> array({image.rows, image.cols});
  for (int y = 0; y < image.rows; ++y) std::memcpy(array.mutable_data(y, 0), image.ptr(y), image.cols);
  return array;
}

}  // namespace sextant
