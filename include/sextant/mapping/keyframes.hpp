// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "sextant/mapping/marker_recording.hpp"

namespace sextant {

/// Indices of the instants with new information: one in which a marker is seen for the first time or has
/// moved by two pixels or more in the image of a camera since the last of them that showed it, and all
/// without markers. Images of a robot at rest have the same errors, and one of them as much information as
/// all.
std::vector<size_t> keyframes(const MarkerRecording& recording);

}  // namespace sextant
