// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace sextant {

/// Replaces a file's content completely or not at all: temporary file in the same folder, fsync, rename.
/// @throws std::runtime_error with the path and the system's error message
void writeFileAtomically(const std::string& path, const std::string& content);

}  // namespace sextant
