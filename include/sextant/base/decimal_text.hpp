// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace sextant {

/// The shortest decimal text that reads back as the same number.
std::string shortestDecimal(double value);

}  // namespace sextant
