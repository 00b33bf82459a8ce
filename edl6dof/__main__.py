"""``python -m edl6dof``: the command line."""

from edl6dof.cli import main

if __name__ == "__main__":
    main()
