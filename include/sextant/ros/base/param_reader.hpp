// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/node_handle.h>

#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace sextant {

/// Reads private parameters over the defaults of a struct. A wrong type or a name that nobody reads is an
/// error: roscpp's own param() would silently keep the default.
class ParamReader {
 public:
  explicit ParamReader(const ros::NodeHandle& private_node) : node_(private_node) {}

  /// Leaves value as it is where the parameter is not set. A whole number is taken where a real one is
  /// expected.
  /// @throws std::invalid_argument with the full name and the type that is needed
  void read(const std::string& name, bool& value);
  void read(const std::string& name, int& value);
  void read(const std::string& name, double& value);
  void read(const std::string& name, std::string& value);
  void read(const std::string& name, std::vector<std::string>& value);
  void read(const std::string& name, std::vector<double>& value);
  void read(const std::string& name, std::map<std::string, double>& value);
  void read(const std::string& name, std::map<std::string, std::string>& value);

  /// A text that may look like a number, which roslaunch and rosrun then make of it: 0 is read as "0".
  void readWord(const std::string& name, std::string& value);

  /// Call after the last read().
  /// @throws std::invalid_argument that names the parameters that were set but never read, and those that
  /// exist
  void rejectUnknown() const;

  /// params.validate(), whose messages begin with the name of a parameter, with that name in full.
  template <typename Params>
  void validate(const Params& params) const {
    try {
      params.validate();
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("parameter " + node_.getNamespace() + "/" + error.what());
    }
  }

 private:
  template <typename T>
  void readAs(const std::string& name, T& value, const char* type);

  ros::NodeHandle node_;
  std::set<std::string> known_;
};

/// @throws std::invalid_argument for a name that is no topic's: roscpp would find out only when a nodelet is
/// half started
void requireTopics(const std::string& name, const std::vector<std::string>& topics);

}  // namespace sextant
