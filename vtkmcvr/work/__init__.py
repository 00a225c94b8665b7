"""What a scene makes kernels do: their work counted, their sources read a second time."""
