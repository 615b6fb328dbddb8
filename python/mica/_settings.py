"""Python's values in the words of a job file and of the command line."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from mica._errors import UsageError


def toml_value(name: str, value: object) -> str:
    """A value as TOML on one line. `name` says where it stands, if it is none."""
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, os.PathLike):
        value = os.fspath(value)
    if isinstance(value, str):  # a JSON string is a TOML string, but for one character
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Mapping):
        return (
            "{ " + ", ".join(f"{_key(name, key)} = {toml_value(f'{name}.{key}', v)}" for key, v in value.items()) + " }"
        )
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml_value(f"{name}[{n}]", v) for n, v in enumerate(value)) + "]"
    raise UsageError(f"{name}: found a {type(value).__name__}; expected a number, a text, a list or a dict")


def _key(name: str, key: object) -> str:
    if not isinstance(key, str):
        raise UsageError(f"{name}: found the key {key!r}; expected a text")
    return json.dumps(key, ensure_ascii=False)


def toml_document(job: Mapping[str, Any]) -> str:
    """A dict as a TOML document, one line a key."""
    return "".join(f"{_key('job', key)} = {toml_value(key, value)}\n" for key, value in job.items())


def assignments(values: Mapping[str, Any], prefix: str = "") -> list[str]:
    """`key.path=value` of each value, as `mica render --set` takes it; dicts are merged key by key."""
    found = []
    for key, value in values.items():
        path = f"{prefix}{key}"
        found += assignments(value, path + ".") if isinstance(value, Mapping) else [f"{path}={toml_value(path, value)}"]
    return found


def surface_settings(settings: Mapping[str, object]) -> list[tuple[str, str]]:
    """Settings of a map, as TOML."""
    return [(key, toml_value(key, value)) for key, value in settings.items() if value is not None]


def method_settings(settings: Mapping[str, object]) -> list[tuple[str, str]]:
    """Settings of a method, as its options on the command line."""

    def text(key: str, value: object) -> str:
        if isinstance(value, str):
            return value
        if isinstance(value, (np.ndarray, np.generic)):
            value = value.tolist()
        if isinstance(value, (list, tuple)):
            return ",".join(text(key, v) for v in value)
        if isinstance(value, (int, float)):
            return toml_value(key, value)
        raise UsageError(f"{key}: found a {type(value).__name__}; expected a number, a pair or a word")

    return [(key, text(key, value)) for key, value in settings.items() if value is not None]
