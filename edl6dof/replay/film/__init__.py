"""The film of a flight: pace, shots, stage, titles and encoder."""
