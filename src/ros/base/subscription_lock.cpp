// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#include "sextant/ros/base/subscription_lock.hpp"

namespace sextant {
namespace {

// Of all nodelets in the process, whichever library they come from.
std::mutex& subscriptionMutex() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

SubscriptionLock::SubscriptionLock() : lock_(subscriptionMutex()) {}

}  // namespace sextant
