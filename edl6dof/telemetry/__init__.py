"""The record of a flight: channels, the sample that compiled code fills, columns, the timeline."""
