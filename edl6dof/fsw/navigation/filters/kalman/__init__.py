"""The parts of the error-state Kalman filter; scalar updates and antenna serve other filters too."""
