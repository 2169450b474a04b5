// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "image_arrays.hpp"

#include <cstring>

#include "sextant/images/grey_image.hpp"

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

pybind11::array_t<uint8_t> arrayFromColour(const cv::Mat& image) {
  pybind11::array_t<uint8_t> array({image.rows, image.cols, 3});
  for (int y = 0; y < image.rows; ++y) std::memcpy(array.mutable_data(y, 0, 0), image.ptr(y), 3 * image.cols);
  return array;
}

cv::Mat matrixFromArray(const pybind11::array& array) {
  const bool numbers = pybind11::isinstance<pybind11::array_t<float>>(array);
  if (!numbers && !pybind11::isinstance<pybind11::array_t<uint8_t>>(array))
    throw pybind11::value_error("descriptors must be float32 or uint8");
  if (array.ndim() != 2 || !(array.flags() & pybind11::array::c_style))
    throw pybind11::value_error("descriptors must be of shape (n, width), without gaps");
  return {static_cast<int>(array.shape(0)), static_cast<int>(array.shape(1)), numbers ? CV_32F : CV_8U,
          const_cast<void*>(array.data())};
}

pybind11::array arrayFromMatrix(const cv::Mat& matrix) {
  const auto type = matrix.depth() == CV_32F ? pybind11::dtype::of<float>() : pybind11::dtype::of<uint8_t>();
  pybind11::array array(type, {matrix.rows, matrix.cols});
  const size_t bytes = matrix.cols * matrix.elemSize();
  for (int y = 0; y < matrix.rows; ++y)
    std::memcpy(static_cast<char*>(array.mutable_data()) + y * bytes, matrix.ptr(y), bytes);
  return array;
}

}  // namespace sextant
