# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Reports on place maps: comparison of methods, what predicts a correct answer, tables, plots and pages."""
