// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "marker_search.hpp"
#include "sextant/detection/marker_detector.hpp"

namespace sextant {

/// Creates a search with libapriltag, for several of its families in one pass.
/// @throws std::out_of_range for an unknown family
/// @throws std::invalid_argument if the table of corrected codes would not fit in memory
std::unique_ptr<MarkerSearch> makeAprilTagSearch(const DetectorParams& params,
                                                 const std::vector<std::string>& families);

}  // namespace sextant
