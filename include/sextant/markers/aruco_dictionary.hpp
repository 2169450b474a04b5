// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/aruco.hpp>
#include <string>
#include <vector>

namespace sextant {

std::vector<std::string> arucoDictionaries();
/// @throws std::out_of_range for a name that is not in arucoDictionaries()
cv::Ptr<cv::aruco::Dictionary> makeArucoDictionary(const std::string& name);

}  // namespace sextant
