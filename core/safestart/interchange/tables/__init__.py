"""Tables in and out: states and attitudes as CSV, Parquet, MATLAB's .mat."""
