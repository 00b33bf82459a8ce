"""Results for other programs: CCSDS messages, NESC tables, csv, MATLAB and netCDF files."""
