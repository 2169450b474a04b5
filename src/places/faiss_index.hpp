// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "sextant/places/descriptor_index.hpp"

namespace sextant {

/// Creates an inverted file. Real values are quantized to a byte each, after a PCA to 64 dimensions if there
/// are enough samples; binary descriptors are stored unmodified.
/// @param samples training descriptors, CV_32F or CV_8U, not empty, continuous
/// @param expected expected number of descriptors
std::unique_ptr<DescriptorIndex> makeFaissIndex(const cv::Mat& samples, int64_t expected);

/// Reads an index, see readDescriptorIndex().
std::unique_ptr<DescriptorIndex> readFaissIndex(const std::string& path, int64_t offset);

}  // namespace sextant
