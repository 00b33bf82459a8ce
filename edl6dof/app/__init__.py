"""What the commands of :mod:`edl6dof.cli` do once their heavy imports are loaded."""
