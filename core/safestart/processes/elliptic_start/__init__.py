"""The elliptic-start process: the closed-form certificate on an elliptic orbit."""
