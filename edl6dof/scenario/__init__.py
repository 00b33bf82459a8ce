"""The scenario file: its schema, and what is built from it for the truth and for the flight computer."""
