"""Recipes: a picture says how it was made, and can be made again."""
