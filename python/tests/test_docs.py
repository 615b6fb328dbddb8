"""The documentation is what the module is."""

import importlib.util
import inspect
import re

import numpy as np
import pytest

import mica


@pytest.fixture(scope="module")
def api_page(root):
    specification = importlib.util.spec_from_file_location("api_page", root / "python" / "tools" / "api_page.py")
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


def test_the_api_page_is_made_of_the_docstrings(root, api_page):
    assert (root / "docs" / "api" / "python.md").read_text() == api_page.page(), (
        "python/tools/api_page.py makes it anew"
    )


def public_functions():
    for name in mica.__all__:
        member = getattr(mica, name)
        if inspect.isfunction(member):
            yield name, member
        elif inspect.isclass(member) and member.__module__.startswith("mica._") and "__init__" in vars(member):
            if member is not mica.DeviceInfo:
                yield name, member
            for key, value in vars(member).items():
                function = getattr(value, "__func__", value)
                if inspect.isfunction(function) and (not key.startswith("_") or key == "__call__"):
                    yield f"{name}.{key}", function


@pytest.mark.parametrize(("name", "member"), list(public_functions()))
def test_docstrings_tell_of_every_parameter(name, member):
    text = inspect.getdoc(member)
    assert text, name
    if "arguments and errors as of" in text or "which says more" in text:
        return
    parameters = inspect.signature(member).parameters
    for parameter in parameters:
        assert parameter in ("self", "cls", "args") or re.search(rf"\b{parameter}\b[^:\n]*:", text), (
            f"{name}: {parameter}"
        )


def blocks(path):
    return re.findall(r"```python\n(.*?)```", path.read_text(), re.DOTALL)


def test_the_page_on_python_runs(root, tmp_path, monkeypatch):
    """Its blocks one after the other, as a reader would type them."""
    (tmp_path / "data").symlink_to(root / "data")
    monkeypatch.chdir(tmp_path)
    names = {}
    for block in blocks(root / "docs" / "python.md"):
        exec(block, names)
    assert np.isfinite(names["density"]).all()
    assert (tmp_path / "shell.exr").exists()
