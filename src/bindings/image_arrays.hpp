// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/numpy.h>

#include <opencv2/core/mat.hpp>

namespace sextant {

/// An 8-bit image as a NumPy array; views on it are valid as long as the array exists.
using ImageArray = pybind11::array_t<uint8_t, pybind11::array::c_style | pybind11::array::forcecast>;
cv::Mat imageFromArray(const ImageArray& array);
pybind11::array_t<uint8_t> arrayFromImage(const cv::Mat& image);
/// Copies an 8-bit RGB image.
pybind11::array_t<uint8_t> arrayFromColour(const cv::Mat& image);

/// A view, without a copy, on a C-contiguous array of float32 or uint8; valid as long as the array exists.
/// @throws pybind11::value_error for another type or shape
cv::Mat matrixFromArray(const pybind11::array& array);
pybind11::array arrayFromMatrix(const cv::Mat& matrix);

}  // namespace sextant
