"""Access control: keys, roles, rates, and places in costly calls."""
