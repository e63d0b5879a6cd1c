"""The hold-region process: errors at the hold point that the LQR corrects within corridor and thrust."""
