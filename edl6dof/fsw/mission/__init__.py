"""The mission as a table: phases, what guides and controls each, and what ends it."""
