"""What the laws estimate in flight: air, drag, disturbance of the flight path."""
