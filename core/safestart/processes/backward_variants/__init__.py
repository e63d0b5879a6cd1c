"""The backward-variants process: nominal, robust and stochastic backward reachable sets side by side."""
