// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

namespace sextant {

/// The grey image that every detector works on, from 8-bit grey (the same memory), BGR or BGRA.
/// @throws std::invalid_argument for any other type
cv::Mat greyImage(const cv::Mat& image);

}  // namespace sextant
