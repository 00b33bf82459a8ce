"""The scenario file: its schema, and the records of truth and belief that are built from it."""
