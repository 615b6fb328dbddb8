"""What Mica raises: each error is also one of the standard library's, which callers may know already."""


class Error(Exception):
    """Any error of Mica. The message says where, what was found and what was expected."""


class UsageError(Error, ValueError):
    """What was asked for is wrong: an argument, a setting, a job, a query."""


class FileError(Error, OSError):
    """A file cannot be read, is damaged or cannot be written. The message begins with its path."""


class DeviceError(Error, RuntimeError):
    """An OpenCL device is missing or failed."""


class Cancelled(Error):
    """Work that was told to stop; users see what told it, such as KeyboardInterrupt."""
