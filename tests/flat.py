"""The command with all files of a build side by side, as tests have them: python tests/flat.py build ..."""

from __future__ import annotations

import sys

from camgen.cli import main
from camgen.files import shelves

if __name__ == "__main__":
    shelves.MOST_FLAT = 10**6
    main(sys.argv[1:])
