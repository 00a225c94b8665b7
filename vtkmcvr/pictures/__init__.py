"""Pictures: what a render gives, how it is shown, denoised and written."""
