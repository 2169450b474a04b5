// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include "sextant/core/descriptor_index.hpp"

namespace sextant {

/// Inverted lists: descriptors of numbers reduced to 64 bytes or fewer each, bits as they are.
std::unique_ptr<DescriptorIndex> makeFaissIndex(const cv::Mat& samples, int64_t expected);

/// See readDescriptorIndex().
std::unique_ptr<DescriptorIndex> readFaissIndex(const std::string& path, int64_t offset);

}  // namespace sextant
