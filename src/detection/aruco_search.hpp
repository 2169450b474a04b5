// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "marker_search.hpp"
#include "sextant/detection/marker_detector.hpp"

namespace sextant {

/// Creates a search with OpenCV's aruco module, for one dictionary. @throws std::out_of_range for an unknown
/// dictionary
std::unique_ptr<MarkerSearch> makeArucoSearch(const DetectorParams& params, const std::string& dictionary);

}  // namespace sextant
