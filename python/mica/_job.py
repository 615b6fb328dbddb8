"""Jobs: scenes, and what is wanted of them."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, overload

from mica import _mica
from mica._device import open_device
from mica._image import Image
from mica._settings import assignments, toml_document
from mica._work import Progress, Report, run


class Job:
    """A scene and what is wanted of it: the keys of a job file as a dict, docs/job.md.

    Args:
        job: nested dicts, lists, numbers and texts; arrays stand for lists.
        folder: that file names in it are relative to.
        set: values to put in place of the job's: {"camera.fov": 30, "light.0.intensity": [9, 9, 9]}.

    Raises:
        UsageError: with everything that is wrong, a line each.
        FileError: a file that it names cannot be read.
    """

    def __init__(
        self,
        job: Mapping[str, Any],
        *,
        folder: str | os.PathLike[str] = ".",
        set: Mapping[str, Any] | None = None,
    ) -> None:
        text, overrides = toml_document(job), assignments(set or {})
        self._take(run(lambda *_: _mica.Job.parse(text, os.fsencode(folder), overrides)))

    @classmethod
    def load(cls, path: str | os.PathLike[str], set: Mapping[str, Any] | None = None) -> Job:
        """Reads a job file.

        Args:
            path: TOML; file names in it are relative to its folder.
            set: values to put in place of the file's, as of `mica render --set`.

        Raises:
            FileError: it cannot be read.
            UsageError: with everything that is wrong, a line each.
        """
        overrides = assignments(set or {})
        made = cls.__new__(cls)
        made._take(run(lambda *_: _mica.Job.load(os.fsencode(path), overrides)))
        return made

    def _take(self, job: _mica.Job) -> None:
        self._job = job
        self._renderers: dict[int, _mica.Renderer] = {}

    @property
    def width(self) -> int:
        """Pixels."""
        return self._job.width

    @property
    def height(self) -> int:
        """Pixels."""
        return self._job.height

    @property
    def frames(self) -> range:
        """The numbers of its frames."""
        return range(self._job.first_frame, self._job.last_frame + 1)

    def plan(self) -> str:
        """What would be built, compiled and allocated, in words; builds nothing."""
        return self._job.plan()

    @overload
    def render(self, frames: int | None = None, *, device: int = 0, progress: Progress | None = None) -> Image: ...

    @overload
    def render(
        self, frames: Iterable[int], *, device: int = 0, progress: Progress | None = None
    ) -> Iterator[Image]: ...

    def render(
        self, frames: int | Iterable[int] | None = None, *, device: int = 0, progress: Progress | None = None
    ) -> Image | Iterator[Image]:
        """Renders one frame, or several one by one: `for image in job.render(job.frames)`.

        What frames share is built once. An image depends on the job and the frame alone, to the bit.

        Args:
            frames: a frame, the first unless given; or any number of them.
            device: its number in `mica.devices()`.
            progress: called with (rows done, all) of each frame; what it raises ends the call.

        Returns:
            An Image, or an iterator that renders the next one when it is asked for.

        Raises:
            UsageError: the job has no such frame.
            FileError: a file that the job names is missing or damaged.
            DeviceError: there is no such device, or it failed.
        """
        if frames is None:
            frames = self.frames.start
        if isinstance(frames, int):
            return self._render(frames, device, progress)
        return (self._render(frame, device, progress) for frame in frames)

    def _render(self, frame: int, device: int, progress: Progress | None) -> Image:
        def work(cancellation: _mica.CancellationToken, report: Report | None) -> _mica.Image:
            if device not in self._renderers:
                self._renderers[device] = _mica.Renderer(open_device(device), self._job)
            return self._renderers[device].render(frame, cancellation, report)

        return Image._of(run(work, progress))

    def __repr__(self) -> str:
        frames = f", frames {self.frames.start} to {self.frames.stop - 1}" if len(self.frames) > 1 else ""
        return f"Job({self.width} x {self.height} pixels{frames})"
