// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "sextant/places/descriptor_index.hpp"

namespace sextant {

/// Creates an empty index of one of OpenCV's matchers, over the unmodified descriptors.
/// @param type  CV_32F or CV_8U
/// @param width elements of a descriptor
std::unique_ptr<DescriptorIndex> makeMatcherIndex(const std::string& matcher, int type, int width);

/// Reads an index, see readDescriptorIndex(). Null if there is none of a matcher at the offset.
std::unique_ptr<DescriptorIndex> readMatcherIndex(const std::string& path, int64_t offset);

}  // namespace sextant
