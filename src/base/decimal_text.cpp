// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/base/decimal_text.hpp"

#include <cstdio>
#include <cstdlib>

namespace sextant {

std::string shortestDecimal(double value) {
  char text[32];
  for (int digits = 15; digits <= 17; ++digits) {  // %g drops trailing zeros
    std::snprintf(text, sizeof text, "%.*g", digits, value);
    if (std::strtod(text, nullptr) == value) break;
  }
  return text;
}

}  // namespace sextant
