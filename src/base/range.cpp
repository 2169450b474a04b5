// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/base/range.hpp"

#include <sstream>
#include <stdexcept>

namespace sextant {
namespace {

constexpr int kDigits = 12;  // significant digits of the limits, so that 0.9999999 is not written as 1

}  // namespace

void Range::require(const std::string& name, double value, const std::string& unit) const {
  const bool above = left_ == '(' ? value > low_ : value >= low_;
  const bool below = right_ == ')' ? value < high_ : value <= high_;
  if (above && below) return;
  std::ostringstream message;
  message << name << " is " << value << ", allowed is " << text() << (unit.empty() ? "" : " ") << unit;
  throw std::invalid_argument(message.str());
}

std::string Range::text() const {
  std::ostringstream text;
  text.precision(kDigits);
  text << left_ << low_ << ", " << high_ << right_;
  return text.str();
}

}  // namespace sextant
