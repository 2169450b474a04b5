// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/numpy.h>

#include <opencv2/core/mat.hpp>

namespace sextant {

/// An image of 8-bit grey as a view, without a copy; it lives as long as the array does.
using ImageArray = pybind11::array_t<uint8_t, pybind11::array::c_style | pybind11::array::forcecast>;
cv::Mat imageFromArray(const ImageArray& array);
pybind11::array_t<uint8_t> arrayFromImage(const cv::Mat& image);
/// An image of 8-bit red, green and blue.
pybind11::array_t<uint8_t> arrayFromColour(const cv::Mat& image);

/// Rows of float32 or uint8 as a view, without a copy where they are continuous; it lives as long as the
/// array.
cv::Mat matrixFromArray(const pybind11::array& array);
pybind11::array arrayFromMatrix(const cv::Mat& matrix);

}  // namespace sextant
