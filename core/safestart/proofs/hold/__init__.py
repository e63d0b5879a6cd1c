"""The checker's part for what holds after the end of `synchronize`: a feedback that keeps an ellipsoid for ever."""
