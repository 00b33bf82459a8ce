"""What becomes of a finished flight: files, tables, replay.  Nothing here knows physics."""
