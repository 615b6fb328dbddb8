"""`python -m mica` is the command line, `mica`."""

import os
import signal
import sys

from mica import _mica

if __name__ == "__main__":
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # as the command has it
    sys.exit(_mica.run_program([b"mica", *map(os.fsencode, sys.argv[1:])]))
