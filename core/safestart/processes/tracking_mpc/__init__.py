"""Process tracking-mpc: MPC for tracking a freely tumbling target (paper 002)."""
