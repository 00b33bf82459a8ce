"""The arrangement of the replay: pages, plots, lanes, phase planes."""
