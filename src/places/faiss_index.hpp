// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "sextant/places/descriptor_index.hpp"

namespace sextant {

/// Inverted lists: numbers as a byte each, of wide descriptors with samples enough at most 64; bits as they
/// are.
/// @param samples CV_32F or CV_8U, not empty, without gaps
std::unique_ptr<DescriptorIndex> makeFaissIndex(const cv::Mat& samples, int64_t expected);

/// See readDescriptorIndex().
std::unique_ptr<DescriptorIndex> readFaissIndex(const std::string& path, int64_t offset);

}  // namespace sextant
