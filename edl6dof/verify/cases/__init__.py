"""One file for each check case, with what it verifies and against what."""
