"""Layers of glints over the pictures of other renderers."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from mica import _mica
from mica._device import open_device
from mica._errors import UsageError
from mica._settings import assignments
from mica._work import Progress, run


class GlintLayer(NamedTuple):
    """What `glints` has written, and what became of the pixels of the G-buffer.

    Attributes:
        channels: of the file.
        covered: pixels with a material.
        one_sided: of these, at rims and seams.
        without_footprint: of these, which show nothing.
        broken: pixels with numbers that are none, which show nothing.
        queries: that were answered.
        notes: what was assumed, and what that cost.
    """

    channels: list[str]
    covered: int
    one_sided: int
    without_footprint: int
    broken: int
    queries: int
    notes: list[str]


def glints(
    gbuffer: str | os.PathLike[str],
    scene: str | os.PathLike[str],
    output: str | os.PathLike[str],
    *,
    camera: str | os.PathLike[str] | None = None,
    preset: str = "",
    channels: Mapping[str, str] | None = None,
    other_ids: str = "refuse",
    filter: str = "gaussian",
    filter_width: float | None = None,
    scale: int = 1,
    per_lamp: bool = False,
    aovs: Sequence[str] = (),
    set: Mapping[str, Any] | None = None,
    device: int = 0,
    progress: Progress | None = None,
) -> GlintLayer:
    """Makes a layer of glints over another renderer's picture from its G-buffer, docs/glints.md; as `mica glints`.

    The file is written whole or not at all, and depends on the files and settings alone, to the bit.

    Args:
        gbuffer: OpenEXR of 32-bit floats, one sample through each pixel's centre.
        scene: job file with surfaces and materials, each of which has its `id`.
        output: the layer, FILE.exr, to be added to the picture.
        camera: file of camera and lamps, JSON; the G-buffer's name with .json unless given.
        preset: whose names of channels are looked for: "blender5", "blender3", "mitsuba", "arnold" or "karma"; "": any.
        channels: layers or channels by role, {"uv": "st.x,st.y"}.
        other_ids: "refuse" or "skip" ids that no material has.
        filter: of the picture below, "gaussian", "blackman-harris" or "box".
        filter_width: in pixels, 0.1 to 8; the filter's own unless given.
        scale: pixels of the G-buffer a pixel of the layer and axis, 1 to 16.
        per_lamp: besides their sum a layer for each lamp.
        aovs: any of "D", "footprint", "error" and "coverage".
        set: values to put in place of the scene's, as of `mica glints --set`.
        device: its number in `mica.devices()`.
        progress: called with (rows done, all); what it raises ends the call.

    Returns:
        A GlintLayer: what was written, and what became of the buffer's pixels.

    Raises:
        UsageError: settings or a scene that make no sense, or an output that is read as well.
        FileError: a file that cannot be used, with its place.
        DeviceError: there is no such device, or it failed.
    """
    if other_ids not in ("refuse", "skip"):
        raise UsageError(f"other_ids: found {other_ids!r}; expected 'refuse' or 'skip'")
    settings = _mica.GlintSettings()
    settings.preset, settings.filter, settings.filter_width = preset, filter, float(filter_width or 0)
    settings.channels = [f"{role}={name}" for role, name in (channels or {}).items()]
    settings.skips_other_ids, settings.scale, settings.per_lamp = other_ids == "skip", scale, per_lamp
    settings.aovs, settings.overrides = list(aovs), assignments(set or {})
    files = os.fsencode(gbuffer), os.fsencode(scene), os.fsencode(output), os.fsencode("" if camera is None else camera)

    def work(cancellation: _mica.CancellationToken, report: Any) -> GlintLayer:
        made = _mica.write_glints(open_device(device), *files, settings, cancellation, report)
        return GlintLayer(*(getattr(made, field) for field in GlintLayer._fields))

    return run(work, progress)
