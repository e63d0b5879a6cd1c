"""The coverage process: safe percentage per operating point."""
