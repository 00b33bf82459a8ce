"""The review of one flight: the words, tables and figures of an entry, descent and landing review."""
