// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/base/range.hpp"

#include <sstream>
#include <stdexcept>

namespace sextant {

void Range::require(const std::string& name, double value, const std::string& unit) const {
  const bool above = open_ ? value > low_ : value >= low_;
  if (above && value <= high_) return;
  std::ostringstream text;
  text << name << " is " << value << ", allowed is " << (open_ ? "(" : "[") << low_ << ", " << high_ << "]"
       << (unit.empty() ? "" : " ") << unit;
  throw std::invalid_argument(text.str());
}

void requireOneOf(const std::string& name, const std::string& value,
                  const std::vector<std::string>& allowed) {
  std::string names;
  for (const std::string& each : allowed) {
    if (value == each) return;
    names += (names.empty() ? "" : ", ") + each;
  }
  throw std::invalid_argument(name + " is '" + value + "', allowed is one of " + names);
}

}  // namespace sextant
