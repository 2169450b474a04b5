// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace sextant {

/// Replaces a file's content or leaves it as it was: temporary file beside it, fsync, rename.
/// @throws std::runtime_error that names the path and the system's reason
void writeFileAtomically(const std::string& path, const std::string& content);

/// The shortest decimal text that reads back as the same number.
std::string shortestDecimal(double value);

}  // namespace sextant
