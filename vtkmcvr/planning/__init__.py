"""What a scene becomes for the kernels, part by part; `vtkmcvr.plan` puts it together."""
