"""The atlas process: every start at rest of one operating point, proved."""
