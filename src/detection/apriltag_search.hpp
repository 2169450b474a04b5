// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "marker_search.hpp"
#include "sextant/detection/marker_detector.hpp"

namespace sextant {

/// libapriltag, any number of its families in one pass.
/// @throws std::out_of_range for an unknown family
/// @throws std::invalid_argument for a table of corrected codes that would not fit in memory
std::unique_ptr<MarkerSearch> makeAprilTagSearch(const DetectorParams& params,
                                                 const std::vector<std::string>& families);

}  // namespace sextant
