"""Between VTK's objects and the scene: what users hold already becomes a scene, and back."""
