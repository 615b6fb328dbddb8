"""The methods that there are."""

from mica import _mica


def methods() -> dict[str, str]:
    """Every method's name, with a line on what it is."""
    return {name: _mica.method_info(name).summary for name in _mica.method_names()}
