# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Images of the simulated building on one of several days, a drive through it, and its maps."""
