"""Commands for what flies: tables in C."""
