"""All starts at rest of one operating point, between two proved polygons."""
