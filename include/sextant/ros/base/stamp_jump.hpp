// SPDX-FileCopyrightText: Sextant authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace sextant {

/// Jump back of the stamps, seconds, beyond which a node restarts, because a bag is played again; smaller
/// jumps are messages out of order.
constexpr double kJumpBack = 1.0;

}  // namespace sextant
