"""Readers of volume files, one module per format; `vtkmcvr.readers` chooses between them."""
