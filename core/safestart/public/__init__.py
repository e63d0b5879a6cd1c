"""The calls of `import safestart` and their results, the same here and at a remote service."""
