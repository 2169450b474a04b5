# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Every public name has a description, and the documentation builds without a warning."""

import ast
import importlib
import re
import shutil
import subprocess
from importlib.util import find_spec
from pathlib import Path

import pytest

import sextant

ROOT = Path(__file__).resolve().parents[3]


def undocumented(path):
    """Public functions, classes and methods of a source without a docstring."""

    def visit(node, prefix):
        for each in node.body:
            if isinstance(each, (ast.FunctionDef, ast.ClassDef)) and not each.name.startswith("_"):
                if not ast.get_docstring(each) and each.name not in ("main", "forward"):
                    yield f"{prefix}{each.name}"
                if isinstance(each, ast.ClassDef):
                    yield from visit(each, f"{each.name}.")

    return list(visit(ast.parse(path.read_text()), ""))


def test_python_is_documented():
    sources = sorted((ROOT / "src/sextant").rglob("*.py"))
    assert len(sources) > 200
    found = {str(path.relative_to(ROOT)): undocumented(path) for path in sources}
    assert {path: names for path, names in found.items() if names} == {}


def fields_without_text(path):
    """Fields of public dataclasses and NamedTuples that have no comment behind them and are no parameter."""
    source = path.read_text()
    for each in ast.walk(ast.parse(source)):
        if isinstance(each, ast.ClassDef) and not each.name.startswith("_") and is_record(each):
            for field in each.body:
                if isinstance(field, ast.AnnAssign) and not field.target.id.startswith("_"):
                    text = ast.get_source_segment(source, field)
                    line = source.splitlines()[field.end_lineno - 1]
                    if not re.search(r"  # |= (param|required|nested|struct_param)\(", text + line):
                        yield f"{each.name}.{field.target.id}"


def is_record(node):
    bases = {ast.unparse(base).rpartition(".")[2] for base in node.bases}
    return "NamedTuple" in bases or any("dataclass" in ast.unparse(each) for each in node.decorator_list)


def test_fields_are_documented():
    sources = sorted((ROOT / "src/sextant").rglob("*.py"))
    found = {str(path.relative_to(ROOT)): list(fields_without_text(path)) for path in sources}
    assert {path: names for path, names in found.items() if names} == {}


def has_text(member):
    """Whether a bound member has more than the signature that pybind11 writes."""
    return any(line.strip() and "(self" not in line for line in (member.__doc__ or "").splitlines())


@pytest.mark.parametrize("room", sextant._ROOMS)
def test_bindings_are_documented(room):
    module = importlib.import_module(f"sextant._core.{room}")
    own = {
        name: each
        for name, each in vars(module).items()
        if getattr(each, "__module__", "") == module.__name__
    }
    assert own
    members = {
        f"{name}.{key}": member
        for name, each in own.items()
        if isinstance(each, type) and not hasattr(each, "__members__")
        for key, member in vars(each).items()
        if not key.startswith("_")
    }
    assert [name for name, each in {**own, **members}.items() if not has_text(each)] == []


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which("doxygen"), reason="doxygen is not installed: tools/docs.sh installs it")
@pytest.mark.skipif(
    not find_spec("myst_parser"), reason="myst_parser is not installed: Debian 11 does not have it"
)
def test_documentation_builds_without_warnings():
    done = subprocess.run([ROOT / "tools/docs.sh"], capture_output=True, text=True, timeout=500)
    assert done.returncode == 0, done.stdout + done.stderr
