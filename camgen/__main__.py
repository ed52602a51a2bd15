"""The command `camgen`, and `python -m camgen`: the command line is imported where Ctrl-C is already answered."""

import sys
from typing import NoReturn

from camgen.errors import INTERRUPTED


def main() -> NoReturn:
    """Run the command line and exit, with INTERRUPTED after Ctrl-C, while it is imported too."""
    try:
        from camgen.cli import main as run

        run()
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(INTERRUPTED)


if __name__ == "__main__":
    main()
