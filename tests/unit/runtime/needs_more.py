"""A module that needs a library which is not there."""

import absent_library  # type: ignore[import-not-found]

run = absent_library.run
