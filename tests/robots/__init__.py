"""Tests of the bundled robots: shapes against the reference, annotation against the model."""
