// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/base/strict_yaml.hpp"

#include <gtest/gtest.h>

#include "test_refusal.hpp"

namespace sextant {
namespace {

template <class Read>
std::string mistakeIn(const std::string& text, const Read& read) {
  return refusal<std::runtime_error>([&] { parseYaml(text, "f.yaml", read); });
}

TEST(StrictYaml, ReadsWhatItWrites) {
  const double values[] = {0.1, -2e-300, 3};
  EXPECT_EQ(numbers(YAML::Load(listText(values, 3)), 3), Eigen::Vector3d(0.1, -2e-300, 3));
  for (const std::string text : {"door 7", "a \"quoted\" \\ name", "tür: [", "true", "#"})
    EXPECT_EQ(nonEmptyText(YAML::Load(quotedText(text))), text);
  EXPECT_EQ(wholeNumber(YAML::Load("-7")), -7);
  EXPECT_TRUE(boolean(YAML::Load("true")));
}

TEST(StrictYaml, NamesTheLineOfTheMistake) {
  EXPECT_EQ(mistakeIn("\n1.5x", number), "f.yaml:2: needs a finite number, not '1.5x'");
  EXPECT_EQ(mistakeIn("[1]", number), "f.yaml:1: needs a finite number");
  EXPECT_EQ(mistakeIn(".inf", number), "f.yaml:1: needs a finite number, not '.inf'");
  EXPECT_EQ(mistakeIn("1.0", wholeNumber), "f.yaml:1: needs a whole number");
  EXPECT_EQ(mistakeIn("perhaps", boolean), "f.yaml:1: needs true or false");
  EXPECT_EQ(mistakeIn("''", nonEmptyText), "f.yaml:1: needs a text that is not empty");
  const auto two = [](const YAML::Node& node) { return numbers(node, 2); };
  EXPECT_EQ(mistakeIn("[1, 2, 3]", two), "f.yaml:1: needs a list of 2 numbers");
  EXPECT_EQ(mistakeIn("- 1\n- x", two), "f.yaml:2: needs a finite number, not 'x'");
  EXPECT_EQ(mistakeIn("a: [1", number).find("f.yaml:"), 0u);
}

TEST(StrictYaml, TablesHaveTheirKeysOnceAndNoOthers) {
  const auto read = [](const YAML::Node& node) { requireKeys(node, "a door", {"id"}, {"name"}); };
  EXPECT_EQ(mistakeIn("{id: 1}", read), "accepted");
  EXPECT_EQ(mistakeIn("id: 1\nname: a", read), "accepted");
  EXPECT_EQ(mistakeIn("name: a", read), "f.yaml:1: a door lacks 'id'");
  EXPECT_EQ(mistakeIn("id: 1\nsize: 2", read), "f.yaml:2: unknown name 'size' in a door");
  EXPECT_EQ(mistakeIn("id: 1\nid: 2", read), "f.yaml:2: 'id' is given twice");
  EXPECT_EQ(mistakeIn("[id]", read), "f.yaml:1: a door must be a table of names and values");
}

TEST(StrictYaml, WhatIsRefusedOfAListIsReportedWithItsLine) {
  int sum = 0;
  const auto read = [&](const YAML::Node& list) {
    forEach(list, "doors", [&](const YAML::Node& node) {
      if (wholeNumber(node) < 0) throw std::invalid_argument("no such door");
      sum += wholeNumber(node);
    });
  };
  EXPECT_EQ(mistakeIn("- 1\n- 2\n- -3\n- 4", read), "f.yaml:3: no such door");
  EXPECT_EQ(sum, 3);
  EXPECT_EQ(mistakeIn("7", read), "f.yaml:1: 'doors' must be a list");
}

}  // namespace
}  // namespace sextant
