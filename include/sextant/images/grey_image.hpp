// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

namespace sextant {

/// Converts an 8-bit grey, BGR or BGRA image to 8-bit grey. A grey image is returned without a copy.
/// @throws std::invalid_argument for any other type
cv::Mat greyImage(const cv::Mat& image);

}  // namespace sextant
