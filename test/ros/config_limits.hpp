// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dynamic_reconfigure/Config.h>
#include <gtest/gtest.h>

#include <boost/any.hpp>

namespace sextant {

inline double number(const boost::any& value) {
  if (const auto* real = boost::any_cast<double>(&value)) return *real;
  if (const auto* whole = boost::any_cast<int>(&value)) return static_cast<double>(*whole);
  return static_cast<double>(boost::any_cast<bool>(value));
}

/// Sets one value after the other of a dynamic_reconfigure configuration to its limits: toConfig() and
/// withConfig() must take each to its parameter and back.
template <typename Config, typename Params>
void expectEveryValueReachesItsParameter() {
  const Config least = Config::__getMin__(), most = Config::__getMax__();
  for (const auto& description : Config::__getParamDescriptions__()) {
    if (description->type == "str") continue;  // no least and most
    for (const Config& limit : {least, most}) {
      dynamic_reconfigure::Config one;
      description->toMessage(one, limit);
      Config wanted = toConfig(Params());
      ASSERT_TRUE(description->fromMessage(one, wanted));
      boost::any told, asked;
      description->getValue(toConfig(withConfig(Params(), wanted)), told);
      description->getValue(wanted, asked);
      EXPECT_EQ(number(told), number(asked)) << description->name;
    }
  }
}

}  // namespace sextant
