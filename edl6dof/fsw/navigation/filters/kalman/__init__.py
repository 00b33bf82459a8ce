"""Parts of the error-state Kalman filter; other filters share the measurement update and outlier test."""
