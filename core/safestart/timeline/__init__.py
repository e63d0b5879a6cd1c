"""When may the approach start? Verdicts over a span of time, from the courses of chaser and target."""
