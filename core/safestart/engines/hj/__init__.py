"""Parts of the Hamilton-Jacobi engine: frame, model, target, settings, box, time loop."""
