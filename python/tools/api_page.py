#!/usr/bin/env python3
"""The module's API page, docs/api/python.md, of its docstrings.

api_page.py > docs/api/python.md
"""

import inspect
import re

import mica

HEADER = """# The module `mica`
Made of the module's docstrings by [api_page.py](../../python/tools/api_page.py); [docs/python.md](../python.md) is where to begin.
"""
SECTION = re.compile(r"(Args|Returns|Raises|Attributes):$")
ENTRY = re.compile(r"([\w, ]+): (.*)")


def markdown(docstring):
    """A docstring of paragraphs and sections, whose entries become lists."""
    lines, in_list = [], False
    for line in inspect.cleandoc(docstring).splitlines():
        section, text = SECTION.match(line), line.strip()
        if section:
            lines.append(f"**{section[1]}**\n")
            in_list = section[1] != "Returns"
        elif not text:
            lines.append("")
            in_list = False
        elif in_list and line.startswith("    ") and not line.startswith("     ") and (entry := ENTRY.match(text)):
            lines.append(f"- `{entry[1]}`: {entry[2]}")
        elif line.startswith("    ") and not in_list and not any("**" in previous for previous in lines[-2:]):
            lines.append(line)  # an example
        else:
            lines.append(("  " if in_list else "") + text)
    return "\n".join(lines)


def parameter(p):
    """One as it stands in a signature; annotations are texts."""
    stars = {p.VAR_POSITIONAL: "*", p.VAR_KEYWORD: "**"}.get(p.kind, "")
    default = "" if p.default is p.empty else f" = {p.default!r}"
    return f"{stars}{p.name}: {p.annotation}{default}"


def signature(name, function):
    """On one line, or a parameter a line where that is long."""
    made = inspect.signature(function)
    words = []
    for p in made.parameters.values():
        if p.kind == p.KEYWORD_ONLY and "*" not in words:
            words.append("*")
        if p.name not in ("self", "cls"):
            words.append(parameter(p))
    result = f" -> {made.return_annotation}" if made.return_annotation not in ("None", made.empty) else ""
    text = f"{name}({', '.join(words)}){result}"
    if len(text) > 110:
        text = f"{name}(\n    " + ",\n    ".join(words) + f",\n){result}"
    return f"```python\n{text}\n```"


def members(cls):
    """What a class itself has to say something about, in the order of its source."""
    for name, member in vars(cls).items():
        function = member.__func__ if isinstance(member, classmethod) else member
        is_asked = not name.startswith("_") or name == "__call__"
        if is_asked and inspect.getdoc(function) and (callable(function) or isinstance(function, property)):
            yield name, function


def describe_class(cls):
    parts = [f"## {cls.__name__}"]
    if issubclass(cls, Exception):
        bases = ", ".join(base.__name__ for base in cls.__bases__)
        return [*parts, f"```python\nclass {cls.__name__}({bases})\n```", markdown(cls.__doc__)]
    if cls is mica.DeviceInfo:  # of the bindings, whose functions have no signature
        return [*parts, cls.__doc__ + " See `devices`."]
    if not issubclass(cls, tuple):
        parts.append(signature(cls.__name__, cls.__init__))
    parts.append(markdown(cls.__doc__))
    for name, member in members(cls):
        if isinstance(member, property):
            result = inspect.signature(member.fget).return_annotation
            parts += [f"### {cls.__name__}.{name}", f"`{result}`: {markdown(member.__doc__)}"]
        elif inspect.isfunction(member):
            parts += [f"### {cls.__name__}.{name}", signature(name, member), markdown(member.__doc__)]
    return parts


def page():
    """The page's text."""
    parts = [HEADER]
    for name in mica.__all__:
        member = getattr(mica, name)
        if inspect.isclass(member):
            parts += describe_class(member)
        else:
            parts += [f"## {name}", signature(name, member), markdown(member.__doc__)]
    return "\n\n".join(part.strip("\n") for part in parts if part) + "\n"


if __name__ == "__main__":
    print(page(), end="")
