// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <apriltag/apriltag.h>

#include <memory>
#include <string>
#include <vector>

namespace sextant {

using AprilTagFamily = std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)>;

/// Returns the names of libapriltag's families.
std::vector<std::string> aprilTagFamilies();
/// Creates a family with its code table.
/// @throws std::out_of_range for a name that is not in aprilTagFamilies()
AprilTagFamily makeAprilTagFamily(const std::string& name);

}  // namespace sextant
