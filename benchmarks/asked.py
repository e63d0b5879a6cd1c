"""The arguments of a benchmark that is run by hand. Without them it would start to measure when asked for help."""

from __future__ import annotations

from argparse import ArgumentParser, RawDescriptionHelpFormatter


def parser(text: str | None) -> ArgumentParser:
    """A parser whose ``--help`` shows the module's docstring as it is written; a benchmark adds its arguments."""
    return ArgumentParser(description=text, formatter_class=RawDescriptionHelpFormatter)
