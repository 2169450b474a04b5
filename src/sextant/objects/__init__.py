# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Objects on the floor: found in pictures, located by depth, and a ball that is followed."""
