"""The processes that a process makes: kept running, ended with it, and apart from it."""
