"""What accuracy costs in time, measured on the user's own scene."""
