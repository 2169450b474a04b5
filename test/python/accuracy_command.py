# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Calls of accuracy_statistics."""

import os

from sextant.commands.accuracy_statistics import main


def called(capsys, *arguments):
    """Exit code, and what went to both streams."""
    code = main([str(each) for each in arguments])
    captured = capsys.readouterr()
    return code, captured.out, captured.err


def refused(capsys, *arguments):
    """The one line of a command that wrote nothing."""
    before = sorted(os.listdir())
    code, out, err = called(capsys, *arguments)
    assert (code, out) == (2, "") and err.count("\n") == 1 and sorted(os.listdir()) == before
    return err
