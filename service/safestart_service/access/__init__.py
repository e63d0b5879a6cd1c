"""Who may pass: keys, roles, rates, and places in costly calls."""
