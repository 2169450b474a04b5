// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/base/params.hpp"

#include <algorithm>
#include <cctype>
#include <set>
#include <sstream>
#include <stdexcept>

namespace sextant {
namespace {

/// Checks each number of a parameter against a range.
struct InRange {
  const Range& range;
  const Param& param;

  void operator()(const double* value) const { require("", *value); }
  void operator()(const int* value) const { require("", *value); }
  void operator()(const std::vector<double>* values) const {
    for (const double value : *values) require("", value);
  }
  void operator()(const Numbers& values) const {
    for (size_t i = 0; i < values.count; ++i) require("", values.first[i]);
  }
  template <typename Key>
  void operator()(const std::map<Key, double>* values) const {
    for (const auto& [key, value] : *values) {
      std::ostringstream entry;
      entry << "[" << key << "]";
      require(entry.str(), value);
    }
  }
  template <typename Other>
  void operator()(const Other*) const {
    throw std::logic_error(param.name + " has a range, but no number");
  }
  void require(const std::string& entry, double value) const {
    range.require(param.name + entry, value, param.unit);
  }
};

bool isInTopic(unsigned char letter) { return std::isalnum(letter) != 0 || letter == '_' || letter == '/'; }

void requireTopics(const Param& param) {
  std::set<std::string> known;
  for (const std::string& topic : *std::get<std::vector<std::string>*>(param.value)) {
    const auto refuse = [&](const std::string& reason) {
      throw std::invalid_argument(param.name + ": '" + topic + "' is " + reason);
    };
    if (topic.empty()) refuse("not a topic name: it is empty");
    const auto front = static_cast<unsigned char>(topic.front());
    if (!(std::isalpha(front) != 0 || front == '/' || front == '~') ||
        !std::all_of(topic.begin() + 1, topic.end(), isInTopic))
      refuse("not a topic name: it must have only letters, digits, _ and /, and begin with a letter, / or ~");
    if (!known.insert(topic).second) refuse("listed twice");
  }
}

}  // namespace

Allowed::Allowed(const Range& range) : Allowed(range, range.text()) {}
Allowed::Allowed(const Range& range, std::string in_words)
    : text(std::move(in_words)), check([range](const Param& param) {
        std::visit(InRange{range, param}, param.value);
      }) {}

Allowed oneOf(const std::vector<std::string>& words) {
  std::string names;
  for (const std::string& word : words) names += (names.empty() ? "" : ", ") + word;
  return {names, [words, names](const Param& param) {
            const std::string& value = *std::get<std::string*>(param.value);
            if (std::find(words.begin(), words.end(), value) == words.end())
              throw std::invalid_argument(param.name + " is '" + value + "', allowed is one of " + names);
          }};
}

Allowed notEmpty() {
  return {"not empty", [](const Param& param) {
            if (std::get<std::string*>(param.value)->empty())
              throw std::invalid_argument(param.name + " is empty: " + param.description);
          }};
}

Allowed topics() { return {"", requireTopics}; }

ParamList prefixed(const std::string& prefix, ParamList params) {
  for (Param& param : params) param.name = prefix + param.name;
  return params;
}

ParamList joined(std::initializer_list<ParamList> lists) {
  ParamList all;
  for (const ParamList& list : lists) all.insert(all.end(), list.begin(), list.end());
  return all;
}

std::string typeName(const ParamValue& value) {
  // In the order of the types of ParamValue.
  static const char* const names[] = {"bool",
                                      "int",
                                      "double",
                                      "string",
                                      "list of strings",
                                      "list of doubles",
                                      "list of doubles",
                                      "dictionary of doubles",
                                      "dictionary of doubles",
                                      "dictionary of strings"};
  static_assert(std::size(names) == std::variant_size_v<ParamValue>);
  return names[value.index()];
}

void requireAllowed(const ParamList& params) {
  for (const Param& param : params)
    if (param.allowed.check) param.allowed.check(param);
}

}  // namespace sextant
