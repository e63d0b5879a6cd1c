"""Answers that a client waits for: light ones in threads, heavy ones in helper processes, each pool bounded."""
