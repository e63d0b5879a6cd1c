"""What `import safestart` offers: calls with their results, the same here and at a remote service."""
