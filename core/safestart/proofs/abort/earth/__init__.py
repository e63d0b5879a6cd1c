"""The checker of missed burns about the true Earth: enclosed courses, their linear motion, and the sets near them."""
