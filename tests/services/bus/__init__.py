"""Tests of the bus; a package, so that worker processes can import the handlers."""
