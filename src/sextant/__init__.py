# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Sextant without ROS: what its nodes compute, on arrays, files and bags.

The C++ core is one compiled module for each room, sextant._core.ROOM. Its classes and functions are found
here, and some functions of the Python library; a room's module and libraries are loaded when one of its names
is first used.
"""

import importlib
from typing import Any, List

_ROOMS = (
    "geometry",
    "images",
    "markers",
    "detection",
    "localization",
    "mapping",
    "landmarks",
    "fusion",
    "places",
    "simulation",
)

_FUNCTIONS = {
    "detect_objects": "sextant.objects.object_functions",
    "locate_objects": "sextant.objects.object_functions",
}  # of the Python library, by module


def __getattr__(name: str) -> Any:
    if name in _FUNCTIONS:
        return globals().setdefault(name, getattr(importlib.import_module(_FUNCTIONS[name]), name))
    absent = []
    for room in () if name.startswith("_") else _ROOMS:
        try:
            core = importlib.import_module(f"sextant._core.{room}")
        except ModuleNotFoundError:
            absent.append(room)
            continue
        if hasattr(core, name):
            return globals().setdefault(name, getattr(core, name))
    reason = f" (not built: {', '.join(absent)}; scripts/build.sh builds everything)" if absent else ""
    raise AttributeError(f"module 'sextant' has no attribute '{name}'{reason}")


def __dir__() -> List[str]:
    cores = [importlib.import_module(f"sextant._core.{room}") for room in _ROOMS]
    names = (name for core in cores for name in dir(core) if not name.startswith("_"))
    return sorted({*globals(), *_FUNCTIONS, *names})
