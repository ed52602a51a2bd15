"""`python -m camgen`."""

from camgen.cli import main

if __name__ == "__main__":
    main()
