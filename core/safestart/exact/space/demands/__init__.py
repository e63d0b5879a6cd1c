"""Keep-outs, fields of view and plume rules: demands on a flight in space, and the convex parts that answer them."""
