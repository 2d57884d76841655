"""Holds by descent: postures that keep a handle between the fingers while depths of shapes are driven out."""
