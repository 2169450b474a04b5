# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Simulated street around a block, in a season and a light; with it, the photos of a place map."""
